#include "spikeloop/process/node_program.hpp"
#include "spikeloop/core/code.hpp"

#include <fmt/format.h>

#include <vector>

#include "recording.hpp"
#include "spikeloop/config/weight_file.hpp"
#include "spikeloop/core/connection_faults.hpp"
#include "spikeloop/process/idle_ports.hpp"

namespace spikeloop::music {
namespace {

/// The last line that gives the node a width: where widths that do not fit are looked for.
Location last_connection(const Process& process, const std::vector<PortDescription>& ports) {
  Location last;
  for (const auto& port : ports) {
    if (const Location where = process.where(port.name); where.line > last.line) {
      last = where;
    }
  }
  return last;
}

class NodeProgram {
 public:
  NodeProgram(Process& process, const NodeClass& node_class)
      : process_(process), ports_(node_class.description.ports) {
    const auto& keys = process.common();
    description_.tick = keys.music_timestep;
    description_.seed = keys.seed;
  }

  GraphDescription describe(const NodeClass& node_class, const Parameters& parameters) {
    description_.nodes.push_back({process_.label(), &node_class, parameters,
                                  last_connection(process_, ports_), process_.share(),
                                  threads(node_class)});
    std::vector<std::string> names;
    names.reserve(ports_.size());
    for (const auto& port : ports_) {
      names.push_back(port.name);
    }
    process_.declare_ports(names);
    for (const auto& port : ports_) {
      port.direction == Direction::input ? add_input(port) : add_output(port);
    }
    return description_;
  }

 private:
  unsigned threads(const NodeClass& node_class) const {
    const Parameters keys = process_.read(sharing_parameters());
    const auto count = static_cast<unsigned>(keys.integer("threads"));
    if (!node_class.description.shareable && (count > 1 || process_.share().parts > 1)) {
      throw ConfigurationError(
          process_.where_key(count > 1 ? "threads" : "np"),
          with_code(Code::music_job,
                    "np={} and threads={}, but a node of the class {} cannot be shared out; "
                    "write np=1, and leave out threads",
                    process_.share().parts, count, node_class.description.name));
    }
    return count;
  }

  // Endpoints are named as their port, unless the node itself is named so.
  std::string endpoint_name(const PortDescription& port) const {
    return port.name == process_.label() ? "port " + port.name : port.name;
  }

  std::string node_end(const PortDescription& port) const {
    return process_.label() + "." + port.name;
  }

  void add_input(const PortDescription& port) {
    const bool spikes = port.kind == PortKind::spikes;
    if (!process_.connected_input(port.name, port.kind)) {
      sources_.push_back(make_idle_source({port.name, port.kind, silent_width(port)}));
    } else {
      sources_.push_back(spikes ? process_.spike_input(port.name)
                                : process_.signal_input(port.name));
    }
    description_.sources.push_back({endpoint_name(port), sources_.back().get()});
    description_.connections.push_back(
        {endpoint_name(port) + "." + port.name, node_end(port), 0, 0, process_.where(port.name)});
  }

  void add_output(const PortDescription& port) {
    if (!process_.connected_output(port.name, port.kind)) {
      record_alone(port);
      return;
    }
    const bool spikes = port.kind == PortKind::spikes;
    sinks_.push_back(spikes ? process_.spike_output(port.name) : process_.signal_output(port.name));
    description_.sinks.push_back({endpoint_name(port), sinks_.back().get()});
    description_.connections.push_back(
        {gathered(port), endpoint_name(port) + "." + port.name, 0, 0, process_.where(port.name)});
  }

  // An output that goes nowhere is recorded all the same, where its width is known.
  void record_alone(const PortDescription& port) {
    const bool same = port.width.kind == WidthRule::Kind::same_as;
    const PortDescription& other = ports_[same ? port.width.value : 0];
    const std::uint32_t width = port.width.kind == WidthRule::Kind::fixed ? port.width.value
                                : same && process_.connected_input(other.name, other.kind)
                                    ? process_.width(other.name)
                                    : 0;
    if (width == 0 || !process_.common().record) {
      return;
    }
    sinks_.push_back(make_idle_sink({port.name, port.kind, width}));
    description_.sinks.push_back({endpoint_name(port), sinks_.back().get()});
    description_.connections.push_back(
        {gathered(port), endpoint_name(port) + "." + port.name, 0, 0, process_.where()});
  }

  // Where all channels of an output are: the node itself when it has no share only.
  std::string gathered(const PortDescription& port) {
    if (process_.share().parts == 1 || process_.checking()) {
      return node_end(port);
    }
    const std::string name = "gathering of " + port.name;
    gatherings_.push_back(std::make_unique<NodeClass>(process_.gathering(port.kind)));
    description_.nodes.push_back({name, gatherings_.back().get(), {}, {}});
    description_.connections.push_back({node_end(port), name + ".in", 0, 0, {}});
    return name + ".out";
  }

  std::uint32_t silent_width(const PortDescription& port) const {
    if (port.width.kind == WidthRule::Kind::fixed) {
      return port.width.value;
    }
    if (port.width.kind == WidthRule::Kind::same_as) {
      const auto& other = ports_[port.width.value];
      if (process_.connected_input(other.name, other.kind)) {
        return process_.width(other.name);
      }
    }
    throw ConfigurationError(not_connected(node_end(port)));
  }

  Process& process_;
  const std::vector<PortDescription>& ports_;
  std::vector<std::unique_ptr<NodeClass>> gatherings_;
  std::vector<std::unique_ptr<Source>> sources_;
  std::vector<std::unique_ptr<Sink>> sinks_;
  GraphDescription description_;
};

// What the node leaves behind: learned weights.
void write_results(Graph& graph) {
  for (const Result& result : graph.results()) {
    write_weights(output_folder() / result.file, result.table);
  }
}

}  // namespace

std::vector<ParameterDescription> sharing_parameters() {
  return {{.name = "threads",
           .type = ParameterType::integer,
           .default_value = "1",
           .minimum = 1,
           .maximum = 1024,
           .text = "Threads per process that share the output channels"}};
}

int run_node(Process& process, const NodeClass& node_class, const Parameters& parameters,
             const Process::LoopHooks& hooks) {
  NodeProgram program(process, node_class);
  GraphDescription description = program.describe(node_class, parameters);
  process.attach_recorders(description);
  Graph graph(description);
  Process::LoopHooks all = hooks;
  all.after_loop = [&] {
    if (hooks.after_loop) {
      hooks.after_loop();
    }
    write_results(graph);
  };
  return process.run(graph, all);
}

}  // namespace spikeloop::music
