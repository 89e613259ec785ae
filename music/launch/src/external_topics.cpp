#include "external_topics.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <utility>

#include "spikeloop/core/code.hpp"
#include "spikeloop/launch/folders.hpp"
#include "spikeloop/launch/programs.hpp"

namespace spikeloop::launch {

std::string written_place(const MusicFile& file, const MusicSection& section,
                          const Program& program) {
  const MusicKey* key = file.find_key(section, program.external.key);
  return key != nullptr ? key->value : std::string(program.external.otherwise);
}

std::string topic_name(const std::string& written) {
  std::string name = "/" + written;
  for (std::size_t i = name.find("//"); i != std::string::npos; i = name.find("//")) {
    name.erase(i, 1);
  }
  if (name.ends_with('/')) {
    name.pop_back();
  }
  return name.starts_with("/~") ? "" : name;
}

namespace {

namespace fs = std::filesystem;

/// Where a program of ours meets the world.
struct Place {
  std::string name;
  int ros = 0;  ///< 0: no topic
  Location where;
};

/// The version of ROS, and a topic; 0, and an address.
using Key = std::pair<int, std::string>;

class ExternalTopicsCheck {
 public:
  ExternalTopicsCheck(const MusicFile& file, bool strict) : file_(file), strict_(strict) {}

  Diagnostics run() {
    for (const MusicSection* section : in_written_order(file_)) {
      const Program* program = find_program(file_, *section);
      if (program == nullptr || program->external.key.empty()) {
        continue;
      }
      if (ros_version(file_, *section) == 1) {
        add_node_name(*section);
      }
      const Place place = place_of(*section, *program);
      if (place.name.empty()) {
        continue;
      }
      if (!program->source) {
        add_writer(*section, *program, place);
      } else if (program->ros) {
        listeners_.emplace(Key{place.ros, place.name}, section);
      }
    }
    for (const auto& [topic, listener] : listeners_) {
      check_echo(topic, *listener);
    }
    return std::move(diagnostics_);
  }

 private:
  Place place_of(const MusicSection& section, const Program& program) const {
    const MusicKey* key = file_.find_key(section, program.external.key);
    const std::string written = written_place(file_, section, program);
    return {program.ros ? topic_name(written) : canonical_address(written, section),
            ros_version(file_, section), key != nullptr ? key->where : section.where};
  }

  /// One spelling of an address. Empty: it is another one for each program that binds to it.
  std::string canonical_address(const std::string& written, const MusicSection& section) const {
    constexpr std::string_view kFile = "ipc://";
    const auto colon = written.rfind(':');
    if (written.starts_with(kFile)) {
      const fs::path path = fs::absolute(directory_of(file_.path)) /
                            working_directory(file_, section, directory_of(file_.path)) /
                            written.substr(kFile.size());
      return written == "ipc://*" ? "" : "ipc://" + path.lexically_normal().string();
    }
    if (!written.starts_with("tcp://") || colon < 6) {
      return written;
    }
    std::string host = written.substr(6, colon - 6);
    std::string port = written.substr(colon + 1);
    port.erase(0, std::min(port.find_first_not_of('0'), port.size()));
    host = host == "lo" || host == "localhost" ? "127.0.0.1" : host == "0.0.0.0" ? "*" : host;
    return port.empty() || port == "*" ? "" : fmt::format("tcp://{}:{}", host, port);
  }

  /// The first that publishes there; tcp://*:PORT is every address with this port.
  const MusicSection* writer_at(const Place& wanted) const {
    const std::string& place = wanted.name;
    for (const auto& [key, section] : writers_) {
      const auto& [ros, name] = key;
      if (ros != wanted.ros) {
        continue;
      }
      const bool same_port = name.starts_with("tcp://") && place.starts_with("tcp://") &&
                             name.substr(name.rfind(':')) == place.substr(place.rfind(':'));
      const bool every = name.starts_with("tcp://*:") || place.starts_with("tcp://*:");
      if (name == place || (same_port && every)) {
        return section;
      }
    }
    return nullptr;
  }

  /// ROS ends the older one of two nodes with one name.
  void add_node_name(const MusicSection& section) {
    const MusicKey* key = file_.find_key(section, "ros_node_name");
    if (key == nullptr) {
      return;  // gets a suffix of its own
    }
    const auto [first, is_new] = nodes_.emplace(key->value, &section);
    if (!is_new) {
      diagnostics_.push_back(error_at(
          key->where,
          with_code(Code::topic_conflict,
                    "'{}' and '{}' have the ros_node_name {}, and ROS would end the one that "
                    "comes first; write another ros_node_name in one of them",
                    first->second->label, section.label, key->value)));
    }
  }

  void add_writer(const MusicSection& section, const Program& program, const Place& place) {
    const MusicSection* first = writer_at(place);
    writers_.emplace(Key{place.ros, place.name}, &section);
    if (first == nullptr) {
      return;
    }
    const std::string both =
        fmt::format("'{}' and '{}' both publish {}", first->label, section.label,
                    program.ros ? place.name : "at " + place.name);
    if (program.ros) {
      diagnostics_.push_back(warning_at(
          place.where,
          with_code(Code::topic_conflict,
                    "{}, and the robot obeys both in turn; write another ros_topic in one of them",
                    both),
          strict_));
    } else {
      diagnostics_.push_back(error_at(
          place.where,
          with_code(Code::topic_conflict,
                    "{}, which only one program can; write another zmq_addr in one of them",
                    both)));
    }
  }

  void check_echo(const Key& topic, const MusicSection& listener) {
    const auto writer = writers_.find(topic);
    if (writer == writers_.end()) {
      return;
    }
    const MusicKey* key = file_.find_key(listener, "ros_topic");
    diagnostics_.push_back(warning_at(
        key == nullptr ? listener.where : key->where,
        with_code(Code::topic_conflict,
                  "'{}' subscribes to {}, which '{}' publishes: the job hears itself; write "
                  "another ros_topic in one of them",
                  listener.label, topic.second, writer->second->label),
        strict_));
  }

  const MusicFile& file_;
  bool strict_;
  std::map<Key, const MusicSection*> writers_;
  std::map<Key, const MusicSection*> listeners_;
  std::map<std::string, const MusicSection*> nodes_;
  Diagnostics diagnostics_;
};

}  // namespace

Diagnostics check_external_topics(const MusicFile& file, bool strict) {
  return ExternalTopicsCheck(file, strict).run();
}

}  // namespace spikeloop::launch
