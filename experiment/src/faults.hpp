// Faults are collected, so that one check tells all of them.
#pragma once

#include <algorithm>
#include <functional>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <string_view>
#include <unordered_set>
#include <vector>

#include "spikeloop/core/error.hpp"
#include "spikeloop/core/graph_plan.hpp"
#include "spikeloop/core/reason.hpp"
#include "spikeloop/experiment/experiment.hpp"

namespace spikeloop::bag {
class Reader;
}

namespace spikeloop::experiment {

class Faults {
 public:
  explicit Faults(Diagnostics& list) : list_(list) {
    for (const Diagnostic& fault : list) {
      told_.insert(fault.text());
    }
  }

  /// The same is not told twice: a node that is misspelt in the middle of a line is the end of two
  /// connections.
  void add(const Error& error) {
    if (told_.insert(error.what()).second) {
      list_.push_back(diagnostic_of(error));
    }
  }
  void add(const Location& where, const std::string& message) {
    add(ConfigurationError(where, message));
  }
  /// Whether `work` did not throw; errors without a place get this one.
  template <typename Work>
  bool attempt(const Location& where, Work&& work) {
    try {
      located_at(where, [&] { return work(), 0; });
      return true;
    } catch (const Error& error) {
      add(error);
      return false;
    }
  }
  std::size_t count() const { return list_.size(); }

 private:
  Diagnostics& list_;
  std::unordered_set<std::string> told_;
};

/// What is known of a node after a look at it alone.
struct Checked {
  bool ports = false;       ///< they are known, so that connections can be checked
  bool parameters = false;  ///< all of it is right: it can be made
};

/// A node's class, keys and files.
Checked resolve_node(const ExperimentNode& entry, const NodeTypes& types,
                     const std::string& directory, Experiment& experiment, Faults& faults);
/// What `simulator: NAME` stands for, if it is not a class of the registry.
/// @throws ConfigurationError with "did you mean".
std::string simulator_kind(const ExperimentNode& entry, const WrittenValue& written);
/// A node that is a simulator: `node` has its name, kind and place. It has no class, and so no
/// ports, before with_simulator_ports().
Checked resolve_simulator(const ExperimentNode& entry, Node node, const std::string& directory,
                          Experiment& experiment, Faults& faults);
/// A key that is a parameter of a script must not be one of all sections of a .music file.
void check_parameter_name(const ExperimentNode& entry, const std::string& name, Faults& faults);
/// Gives simulators the ports that the connections name; these are named in full in the result.
ExperimentFile with_simulator_ports(const ExperimentFile& file, Experiment& experiment,
                                    Faults& faults);
/// Ends, kinds, cycles, delays; widths along every connection; makes every node once that `whole`
/// names, if `trial` wants it.
struct Trial {
  const std::set<std::string>& whole;  ///< nodes without a fault
  bool try_nodes = true;
  SensorWidth sensor_width{};  ///< empty: nobody knows
  /// True if the recorded messages of a sensor have different numbers of values. Empty without a
  /// recording.
  std::function<bool(const Node& sensor)> length_changes{};
};
void resolve_connections(const ExperimentFile& file, const Trial& trial, Experiment& experiment,
                         Faults& faults);

/// The key `layout`. @param whole all nodes could be read
void resolve_layout(const Parameters& keys, bool whole, Experiment& experiment, Faults& faults);

/// Gives the ports whose width is open in `plan` the one that the node itself knows: by the rows
/// and columns of its table, by the robot's message. Returns whether there was one; then `graph`
/// has to be planned again.
bool settle_by_nodes(const GraphPlan& plan, const Trial& trial, GraphDescription& graph,
                     Experiment& experiment, Faults& faults);

/// The key `robot`, and what is known of that robot.
RobotView read_robot(const ExperimentFile& file, const Overrides& overrides,
                     const LookAtRobot& look_at_robot, Experiment& experiment, Faults& faults);
/// The topics of nodes, without ROS. A node whose topic is not one of the robot's is no longer
/// `whole`. @param topics of the robot; none: not known
void check_topics(const Experiment& experiment, const std::vector<RobotTopic>& topics,
                  std::set<std::string>& whole, Faults& faults);

/// `robot: {bag: FILE}`: its keys.
void read_bag_keys(const ExperimentNode& robot, const std::string& directory,
                   Experiment& experiment, Faults& faults);
/// The bag in the robot's place; null: there is none, or it cannot be read.
std::shared_ptr<const bag::Reader> open_bag(const Experiment& experiment, Faults& faults);
/// Width of a sensor by the first message that has a value.
SensorWidth bag_width(std::shared_ptr<const bag::Reader> reader);
/// Compares the first messages of a sensor, see Trial.
bool length_changes(const bag::Reader& reader, const Node& sensor);
/// What the sensors ask of the bag: topics, types and versions. An experiment without duration ends
/// with the bag.
void check_bag(const bag::Reader& reader, const std::set<std::string>& whole,
               Experiment& experiment, Faults& faults);

/// The file whose directory relative paths start in.
inline const std::string& origin_of(const ExperimentFile& file, const Overrides& overrides) {
  return overrides.origin.empty() ? file.path : overrides.origin;
}
std::string in_directory(const std::string& directory, const std::string& path);
[[noreturn]] void refuse_file(const char* key, const Location& where, const char* what,
                              const std::string& path);

/// Whether a value is a list or a map, which is JSON by now, and no name of a file.
inline bool is_in_place(std::string_view text) {
  return text.starts_with('[') || text.starts_with('{');
}

/// Mapping files and experiments have the same fields; their errors speak of the file's.
template <typename Work>
void in_yaml(Work&& work) {
  try {
    work();
  } catch (const ConfigurationError& error) {
    constexpr std::string_view kFile = "'mapping.";
    std::string text = reason_of(error);
    for (auto at = text.find(kFile); at != std::string::npos; at = text.find(kFile)) {
      text.replace(at, kFile.size(), "'fields.");
    }
    throw ConfigurationError(error.where(), text);
  }
}

/// Something that has keys.
struct Keyed {
  const WrittenValues& written;
  std::string what;  ///< "node 'encoder'"
  Location where;
  std::vector<std::string> unread{};         ///< were told of before
  std::map<std::string, Location> places{};  ///< of keys
};

/// Each key by itself: unknown, missing, without unit, wrong. Numbers whose declaration has a unit
/// are written with one.
Parameters resolve_keys(const std::vector<ParameterDescription>& declared, const Keyed& keyed,
                        const WeightLoader& load_weights, Faults& faults);

}  // namespace spikeloop::experiment
