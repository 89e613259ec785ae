// Experiment files: one YAML file that says what is coupled.
//
//   experiment: braitenberg
//   duration: 60 s
//   tick: 1 ms
//   seed: 1
//   sync: lockstep
//   robot: {simulator: mujoco, world: arena.xml}
//   nodes:
//     scan:    {node: ros_sensor, topic: /scan, message: sensor_msgs/LaserScan}
//     encoder: {node: rate_encoder, rate_min: 1 Hz, rate_max: 200 Hz}
//     ...
//   connections:
//     - scan -> encoder [100] -> brain [100] -> decoder [100] -> wheels [2, delay 5 ms]
//
// This is the text alone; spikeloop/experiment/ knows which nodes there are and what they take.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "spikeloop/core/error.hpp"
#include "spikeloop/core/error_handler.hpp"
#include "spikeloop/core/parameters.hpp"

namespace spikeloop {

/// An entry of `nodes`, or `robot`.
struct ExperimentNode {
  std::string name;
  WrittenValues keys;
  Location where;
  std::vector<std::string> unread{};         ///< keys whose values cannot be read
  std::map<std::string, Location> places{};  ///< of the keys, not of their values
};

/// One arrow.
struct ExperimentConnection {
  std::string from;  ///< "scan" or "scan.out"
  std::string to;
  std::uint32_t width = 0;  ///< 0: not written
  WrittenValue delay{};     ///< "5 ms" or "2 ticks"; an empty text: none
  Location where;           ///< of the arrow's target
  Location where_from{};    ///< of its source
};

struct ExperimentFile {
  std::string path;
  WrittenValues keys;  ///< of the whole experiment: experiment, duration, tick, ...
  std::vector<WrittenValue> plugins;
  std::optional<ExperimentNode> robot;
  std::vector<ExperimentNode> nodes;  ///< in the file's order
  std::vector<ExperimentConnection> connections;
  Location where_nodes{};        ///< of the key `nodes`
  Location where_connections{};  ///< of the key `connections`
  bool joined = true;            ///< false: a node or a connection could not be read
};

/// The keys of the whole experiment but those that hold others: robot, plugins, nodes, connections.
std::vector<ParameterDescription> experiment_parameters();
/// Those of `robot`, and of a connection that is written as a map. An empty default: none.
std::vector<ParameterDescription> robot_parameters();
/// Those of the map  camera  in `robot`.
std::vector<ParameterDescription> camera_parameters();
std::vector<ParameterDescription> connection_parameters();

/// Parses the text of a file; `path` only names it in locations. Tells everything that is wrong,
/// and returns what could be read.
/// @throws ConfigurationError "file:line:column: what is wrong; what to write" when nothing can:
/// not YAML, not a map.
ExperimentFile parse_experiment(std::string_view text, const std::string& path,
                                const ErrorHandler& report);
/// The same for a file. @throws FileError when it cannot be read.
ExperimentFile read_experiment_file(const std::filesystem::path& path, const ErrorHandler& report);

/// The same, but the first thing that is wrong is thrown: unknown keys (did you mean), a key
/// written twice, a connection that cannot be read.
ExperimentFile parse_experiment(std::string_view text, const std::string& path);
ExperimentFile read_experiment_file(const std::filesystem::path& path);

}  // namespace spikeloop
