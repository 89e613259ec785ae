// The C++ side of plugin.h. A plug-in is a class and one line:
//
//   class Doubler : public spikeloop::Node {
//    public:
//     static spikeloop::NodeDescription describe();
//     explicit Doubler(const spikeloop::NodeSetup& setup);
//     void step(const spikeloop::Step& step) override;
//   };
//   SPIKELOOP_PLUGIN(Doubler)
//
// The same source can be linked into a program of one's own: compiled with SPIKELOOP_STATIC_PLUGIN
// defined, the line tells Registry::add_linked_plugins() of the class, and exports nothing.
#pragma once

#include <algorithm>
#include <cstdio>
#include <deque>
#include <exception>
#include <memory>
#include <string>
#include <vector>

#include "spikeloop/core/node.hpp"
#include "spikeloop/core/plugin.h"

namespace spikeloop {

/// The class of `NodeType`, which has describe() and a constructor from NodeSetup.
template <typename NodeType>
NodeClass node_class() {
  return {NodeType::describe(), [](const NodeSetup& setup) -> std::unique_ptr<Node> {
            return std::make_unique<NodeType>(setup);
          }};
}

namespace plugin {

/// The plain form of a description; owns what its pointers point to.
class PlainDescription {
 public:
  explicit PlainDescription(NodeDescription description);
  const NodeDescription& description() const { return description_; }
  const std::vector<spikeloop_port>& ports() const { return ports_; }
  const std::vector<spikeloop_parameter>& parameters() const { return parameters_; }

 private:
  NodeDescription description_;
  std::deque<std::string> joined_choices_;
  std::vector<spikeloop_port> ports_;
  std::vector<spikeloop_parameter> parameters_;
};

/// The setup that came across the border, as C++ types.
NodeSetup setup_from(const spikeloop_setup& plain);

inline void write_error(const char* text, char* error, std::uint64_t error_size) {
  std::snprintf(error, error_size, "%s", text);
}

/// A C++ node class as functions that throw nothing across the border.
template <typename NodeType>
class ExportedClass {
 public:
  static const spikeloop_node_class* plain() {
    static const PlainDescription text(NodeType::describe());
    static const spikeloop_node_class exported{text.description().name.c_str(),
                                               text.description().text.c_str(),
                                               text.ports().data(),
                                               text.parameters().data(),
                                               static_cast<std::uint32_t>(text.ports().size()),
                                               static_cast<std::uint32_t>(text.parameters().size()),
                                               &create,
                                               &step,
                                               &counters,
                                               &destroy};
    return &exported;
  }

 private:
  // Counter names must live as long as the node, so they are kept beside it.
  struct Held {
    explicit Held(const NodeSetup& setup) : node(setup) {}
    NodeType node;
    std::vector<Counter> counters;
  };

  static void* create(const spikeloop_setup* setup, char* error, std::uint64_t error_size) {
    try {
      return new Held(setup_from(*setup));
    } catch (const std::exception& exception) {
      write_error(exception.what(), error, error_size);
    } catch (...) {
      write_error("it threw something that is not a std::exception", error, error_size);
    }
    return nullptr;
  }

  static int step(void* held, const spikeloop_step* data, char* error, std::uint64_t error_size) {
    try {
      static_cast<Held*>(held)->node.step(Step(*data));
      return 0;
    } catch (const std::exception& exception) {
      write_error(exception.what(), error, error_size);
    } catch (...) {
      write_error("it threw something that is not a std::exception", error, error_size);
    }
    return 1;
  }

  static std::uint32_t counters(void* held_node, spikeloop_counter* out, std::uint32_t capacity,
                                char* error, std::uint64_t error_size) {
    auto& held = *static_cast<Held*>(held_node);
    try {
      held.counters = held.node.counters();
    } catch (const std::exception& exception) {
      write_error(exception.what(), error, error_size);
      return SPIKELOOP_FAILED;
    } catch (...) {
      write_error("it threw something that is not a std::exception", error, error_size);
      return SPIKELOOP_FAILED;
    }
    const auto count = std::min<std::size_t>(held.counters.size(), capacity);
    for (std::size_t i = 0; i < count; ++i) {
      out[i] = {held.counters[i].name.c_str(), held.counters[i].value};
    }
    return static_cast<std::uint32_t>(count);
  }

  static void destroy(void* held) { delete static_cast<Held*>(held); }
};

/// What a plug-in with these classes exports.
template <typename... NodeTypes>
const spikeloop_plugin* exported_plugin() {
  static const spikeloop_node_class* const classes[] = {ExportedClass<NodeTypes>::plain()...};
  static const spikeloop_plugin exported{sizeof(spikeloop_plugin), SPIKELOOP_ABI_VERSION,
                                         SPIKELOOP_BUILD, classes, sizeof...(NodeTypes)};
  return &exported;
}

/// Makes a class that was linked into the program; nothing of it runs before main() asks.
using MakeClass = NodeClass (*)();

/// Called before main(), by the sources of plug-ins.
void note_linked(MakeClass make_class);

/// Those that were noted, in the order of the program's sources.
const std::vector<MakeClass>& linked_classes();

template <typename... NodeTypes>
struct Linked {
  Linked() { (note_linked(&node_class<NodeTypes>), ...); }
};

}  // namespace plugin
}  // namespace spikeloop

#ifdef SPIKELOOP_STATIC_PLUGIN

/// Notes these node classes for Registry::add_linked_plugins(); write it once a source file.
#define SPIKELOOP_PLUGIN(...)                                             \
  namespace {                                                             \
  const spikeloop::plugin::Linked<__VA_ARGS__> spikeloop_linked_plugin{}; \
  }

#else

/// Makes a shared library a plug-in with these node classes; write it once, at namespace scope.
#define SPIKELOOP_PLUGIN(...)                                       \
  extern "C" const spikeloop_plugin* spikeloop_plugin_entry(void) { \
    return spikeloop::plugin::exported_plugin<__VA_ARGS__>();       \
  }

#endif
