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
#include "spikeloop/core/graph.hpp"
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

/// One arrow; or of an arrow with several senders, as `left, right -> brain`, that of one of them.
struct ExperimentConnection {
  std::string from;  ///< "scan" or "scan.out"
  std::string to;
  std::uint32_t width = 0;  ///< of the receiver's port; 0: not written
  WrittenValue delay{};     ///< "5 ms" or "2 ticks"; an empty text: none
  Location where;           ///< of the arrow's target
  Location where_from{};    ///< of its source
  ChannelRange channels{};  ///< of the sender: "scan[0:50]"
  /// Of an arrow with several senders: not `alone` but for the first one, which comes before.
  Combination combination = Combination::alone;
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

/// What the command line says in place of the file.
struct Setting {
  std::string key;     ///< "seed", "encoder.rate_max", "robot.camera.width", "brain.weights.0.1"
  std::string value;   ///< as it would stand in the file: "100 Hz", "[1, 2]"
  std::string option;  ///< how errors name it: "--set encoder.rate_max"
};
using Settings = std::vector<Setting>;

/// Of "KEY=VALUE". @throws ConfigurationError
Setting parse_setting(const std::string& text);
/// JSON, for the other processes of a run and for its folder.
std::string to_text(const Settings& settings);
/// The same back. @throws nlohmann::json::exception when it is something else.
Settings settings_from_text(const std::string& text);

/// The keys of the whole experiment but those that hold others: robot, plugins, nodes, connections.
std::vector<ParameterDescription> experiment_parameters();
/// The names of all of them.
std::vector<std::string> experiment_keys();
/// Those of `robot`, and of a connection that is written as a map. An empty default: none.
std::vector<ParameterDescription> robot_parameters();
/// Those of the map  episodes.
std::vector<ParameterDescription> episode_parameters();
/// Those of the map  camera  in `robot`.
std::vector<ParameterDescription> camera_parameters();
std::vector<ParameterDescription> connection_parameters();
/// The keys of every node, beside `node`, `simulator` and those of its class.
std::vector<ParameterDescription> node_parameters();

/// Parses the text of a file; `path` only names it in locations. Tells everything that is wrong,
/// and returns what could be read. Of two settings of one key the last one holds.
/// @throws ConfigurationError "file:line:column: what is wrong; what to write" when nothing can:
/// not YAML, not a map.
ExperimentFile parse_experiment(std::string_view text, const std::string& path,
                                const ErrorHandler& report, const Settings& settings = {});
/// The same for a file. @throws FileError when it cannot be read.
ExperimentFile read_experiment_file(const std::filesystem::path& path, const ErrorHandler& report,
                                    const Settings& settings = {});

/// The same, but the first thing that is wrong is thrown: unknown keys (did you mean), a key
/// written twice, a connection that cannot be read.
ExperimentFile parse_experiment(std::string_view text, const std::string& path);
ExperimentFile read_experiment_file(const std::filesystem::path& path);

/// Where the file has what begins at `in_json`, a place in the JSON of a list or a map: a value, or
/// that of a key. The place of the whole list or map when nothing begins there.
Location place_in_file(const WrittenValue& written, const Location& in_json);

}  // namespace spikeloop
