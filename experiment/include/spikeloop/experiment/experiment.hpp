// An experiment whose every word has been checked: the nodes with their parameters, the connections
// with their widths and delays.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "spikeloop/config/experiment_file.hpp"
#include "spikeloop/config/mapping_file.hpp"
#include "spikeloop/core/diagnostic.hpp"
#include "spikeloop/core/graph.hpp"
#include "spikeloop/core/time.hpp"
#include "spikeloop/core/write_failures.hpp"
#include "spikeloop/experiment/changes.hpp"
#include "spikeloop/experiment/node_types.hpp"
#include "spikeloop/messages/dialect.hpp"

namespace spikeloop::bag {
class Reader;
}

namespace spikeloop::experiment {

enum class Sync { realtime, unpaced, lockstep, sim_time };
enum class Ros { none, ros1, ros2 };

/// "realtime", "unpaced", "lockstep", "sim_time", as the key `sync` has them.
Sync sync_named(std::string_view name);
std::string_view name_of(Sync sync);
/// Whether ticks can be late: in the others each begins when the one before is complete.
inline bool follows_clock(Sync sync) {
  return sync == Sync::realtime || sync == Sync::sim_time;
}
/// "none", "1", "2", as the key `ros` has them.
Ros ros_named(std::string_view name);
std::string name_of(Ros ros);
/// What messages are; without ROS as in ROS 1.
messages::Dialect dialect_of(Ros ros);

/// A node of the experiment.
struct Node {
  std::string name;
  std::string kind;  ///< its class
  std::string
      plugin;  ///< file that the class comes from; empty: built in, or SPIKELOOP_PLUGIN_PATH
  Role role = Role::node;
  const NodeClass* node_class = nullptr;
  Parameters parameters;
  WrittenValues written;     ///< as the file has them, without `node` and the keys of every node
  CommandMapping mapping{};  ///< of a ros_command
  bool record = true;        ///< its outputs, or commands, in the run folder
  Location where;
};

/// What goes from an output to an input. Those to one input stand one after another.
struct Connection {
  std::string from;  ///< "encoder.out"
  std::string to;
  PortKind kind = PortKind::signal;
  std::uint32_t width = 0;                   ///< of the sender's port
  std::optional<std::uint32_t> delay_ticks;  ///< as written
  Location where;
  ChannelRange channels{};  ///< of the sender's that the input takes
  Combination combination = Combination::alone;
};

/// "encoder" and "out" of "encoder.out"; "encoder" alone is a node's name, too.
inline std::string node_of(std::string_view end) {
  return std::string(end.substr(0, end.find('.')));
}
inline std::string port_of(std::string_view end) {
  return std::string(end.substr(end.find('.') + 1));
}

/// An output of a node, connected or not.
struct Output {
  std::string node;
  std::string port;
  PortKind kind = PortKind::signal;
  std::uint32_t width = 0;  ///< 0: nothing says it
};

/// The robot's camera.
struct Camera {
  std::string name = "camera";
  std::uint32_t width = 64;  ///< pixels
  std::uint32_t height = 48;
  double rate_hz = 20;
  double field_of_view_deg = 80;  ///< from the left to the right edge
};

/// A robot that is not the vehicle.
struct RobotModel {
  std::string file;
  std::string keyframe;
  double rate_hz = 100;  ///< of joint states and sensors
};

/// An environment of reinforcement learning.
struct Environment {
  std::string name;
  bool slippery = false;
  std::optional<TimeNs> step{};  ///< none: its own
};

/// Episodes of a task; none of a value: that of the environment, or as the key says.
struct Episodes {
  std::optional<std::uint64_t> count{};
  std::optional<TimeNs> time_limit{};
  TimeNs hold = 0;
  TimeNs pause = 0;
  std::vector<std::string> reset{};  ///< nodes that begin anew, too
  std::optional<double> pause_observation{};
  std::optional<double> begin_reward{};
  std::optional<double> end_reward{};
  std::optional<double> failure_reward{};
  std::optional<double> collision_reward{};
  std::string goal{};
};

struct Robot {
  std::string world = "arena.xml";
  std::uint64_t seed = 1;
  Location where;
  std::string bag{};  ///< whose messages stand in the robot's place; empty: it is simulated
  std::optional<Camera> camera{};
  std::optional<RobotModel> model{};         ///< in the vehicle's place
  std::optional<Environment> environment{};  ///< in the robot's place
  /// The open bag. Null without a bag, and if it cannot be read.
  std::shared_ptr<const bag::Reader> recording{};
};

/// The nodes that share a process.
struct Process {
  std::string name;
  std::set<std::string> nodes{};
  bool in_cycle = false;  ///< its data come back to it through other processes
  /// Ticks by which MUSIC may deliver spikes late: in a cycle one, or two if all of them have a
  /// delay of two or more. With two, this process and the others compute at the same time.
  std::uint32_t spike_delay = 0;
};

/// How the nodes are spread over processes; a simulator has a process of its own in all of them.
struct Layout {
  enum class Kind { fused, separate, written } kind = Kind::fused;
  std::vector<Process> processes{};  ///< in the file's order; one unless it is written
  Location where{};
};

struct Experiment {
  std::string path;
  std::string origin;  ///< relative paths start where this file lies; `path`, unless it is a copy
  std::string name;
  std::optional<TimeNs> duration;
  TimeNs tick = 1'000'000;
  std::uint64_t seed = 1;
  Sync sync = Sync::realtime;
  Location sync_where{};
  double real_time_factor = 1;
  OnWriteFailure on_write_failure = OnWriteFailure::stop;
  Ros ros = Ros::none;
  messages::Dialect dialect = messages::Dialect::ros1;  ///< of all messages
  Layout layout{};
  std::optional<Robot> robot;
  std::optional<Episodes> episodes;
  std::vector<Node> nodes;              ///< in the file's order
  std::vector<Connection> connections;  ///< in the file's order
  std::vector<Output> outputs;
  std::vector<std::shared_ptr<const NodeClass>> own_classes;  ///< networks: a class each
  std::set<std::string> files;  ///< absolute paths of what it was made of, beside its own
  Settings settings;            ///< that it was read with
  std::vector<Change> changes;  ///< of a run that is repeated, by time

  const Node& node(std::string_view name) const;
  /// Of an output, or of an input that a connection reaches; 0: nothing says it.
  std::uint32_t width(std::string_view node, std::string_view port) const;
};

/// The messages of a run in place of its robot.
struct Replay {
  std::string bag;  ///< empty: no node takes messages
};

/// What the command line says in place of the file.
struct Overrides {
  Settings settings{};
  std::string origin{};  ///< relative paths start where this file lies; empty: where the file does
  std::optional<Replay> replay{};
  std::string
      changes{};  ///< a file as changes.hpp has it, of the run that is repeated; empty: none
  /// false: the nodes are not tried; somebody else has, or makes them at once.
  bool try_nodes = true;
};

/// Number of values that a message of the robot gives a ros_sensor; 0: as many as are asked for;
/// nothing: this robot does not send it.
using SensorWidth = std::function<std::optional<std::uint32_t>(const Node& sensor)>;

/// A topic of the robot.
struct RobotTopic {
  std::string name;
  std::string message;
  /// Of a topic for commands: paths of all fields that it reads. Of sensors: none.
  std::vector<std::string> fields{};
  std::vector<std::string>
      joints{};  ///< in its messages; empty unless they are sensor_msgs/JointState
  bool takes_commands() const { return !fields.empty(); }
};

/// What is known of the robot.
struct RobotView {
  std::vector<RobotTopic> topics{};  ///< none: not known
  SensorWidth width{};               ///< empty: not known
  TimeNs step = 0;                   ///< of an environment, in which it advances
};
/// Of an experiment whose robot, episodes and ROS have been read. @throws Error when there is no
/// such robot.
using LookAtRobot = std::function<RobotView(const Experiment&)>;

/// Checks everything that can be known before the start: keys, units, bounds, files, widths along
/// every connection, cycles without delay, nodes without connection, what this version does not
/// have; makes every node once. Relative paths start where the file lies. `types` must outlive the
/// result, which is not to be used when there are diagnostics. These are added to `diagnostics`,
/// which is then in the file's order.
/// @param look_at_robot empty: topics and sensors are not held against the robot
Experiment resolve(const ExperimentFile& file, const NodeTypes& types, const Overrides& overrides,
                   Diagnostics& diagnostics, const LookAtRobot& look_at_robot = {});

/// An experiment with all that it points to, or what is wrong with it.
struct Loaded {
  NodeTypes types;
  Diagnostics diagnostics;
  std::optional<Experiment> experiment;  ///< there when the file could be read
};

/// Reads a file, loads its plug-ins and those in SPIKELOOP_PLUGIN_PATH, resolves it. Never throws
/// for what is wrong with these.
std::unique_ptr<Loaded> load(const std::string& path, const Overrides& overrides,
                             const LookAtRobot& look_at_robot = {});

/// Where paths in the file start.
std::string directory_of(const std::string& experiment_path);
/// Absolute path of the file that the user wrote, also if a copy of it is run.
std::string file_of_user(const Experiment& experiment);

}  // namespace spikeloop::experiment
