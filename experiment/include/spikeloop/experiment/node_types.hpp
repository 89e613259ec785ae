// What a node of an experiment can be: a node class, built in or from a plug-in, or an endpoint,
// which belongs to the process: a topic, a recording. All are described by the same declarations.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "spikeloop/core/registry.hpp"

namespace spikeloop::experiment {

/// `simulator`: a process of its own, which simulators.hpp knows.
enum class Role { source, node, sink, simulator };

inline constexpr const char* kRosSensor = "ros_sensor";
inline constexpr const char* kRosEventSensor = "ros_event_sensor";
inline constexpr const char* kRosCommand = "ros_command";
inline constexpr const char* kSpikePlayback = "spike_playback";
inline constexpr const char* kSignalPlayback = "signal_playback";
inline constexpr const char* kNetwork = "network";

/// Whether a kind of node takes the messages of a topic.
inline bool takes_messages(std::string_view kind) {
  return kind == kRosSensor || kind == kRosEventSensor;
}
/// Whether it has a topic at all.
inline bool has_topic(std::string_view kind) {
  return takes_messages(kind) || kind == kRosCommand;
}

class NodeTypes {
 public:
  /// The built-in ones.
  NodeTypes();

  /// Adds the node classes of a plug-in. @throws ConfigurationError as Registry::load_plugin.
  void load_plugin(const std::string& path);
  /// Those of every plug-in in these directories (SPIKELOOP_PLUGIN_PATH).
  void load_plugin_path(std::string_view directories) { registry_.load_plugin_path(directories); }

  /// A plug-in could not be loaded: a class that is unknown may be one of its.
  void set_incomplete() { incomplete_ = true; }
  bool may_lack(std::string_view name) const;

  /// An endpoint's class has no factory. @throws ConfigurationError with "did you mean".
  const NodeClass& find(std::string_view name) const;
  Role role(std::string_view name) const;
  /// The file that load_plugin() got the class from; empty for any other.
  std::string plugin_of(std::string_view name) const;
  std::vector<std::string> names() const;      ///< sorted
  std::vector<std::string> endpoints() const;  ///< those that are no node classes, sorted

 private:
  struct Endpoint {
    Role role;
    NodeClass node_class;
  };
  Registry registry_;
  std::map<std::string, Endpoint, std::less<>> endpoints_;
  std::map<std::string, std::string, std::less<>> plugins_;  ///< class to file
  bool incomplete_ = false;
};

}  // namespace spikeloop::experiment
