#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <map>
#include <set>
#include <utility>

#include "faults.hpp"
#include "spikeloop/core/code.hpp"
#include "spikeloop/experiment/experiment.hpp"

namespace spikeloop::experiment {
namespace {

Location where_of(const ExperimentFile& file, const char* key) {
  const auto found = file.keys.find(key);
  return found == file.keys.end() ? Location{file.path, 0, 0} : found->second.where;
}

void read_times(const Parameters& keys, Experiment& experiment, Faults& faults) {
  if (keys.given("duration")) {
    faults.attempt(keys.where("duration"),
                   [&] { experiment.duration = from_seconds(keys.number("duration")); });
  }
  faults.attempt(keys.where("tick"),
                 [&] { experiment.tick = tick_from_seconds(keys.number("tick")); });
}

/// As delays: a run has as many ticks as its duration says, no more and no less.
void check_duration(const Location& where, const Experiment& experiment, Faults& faults) {
  const TimeNs duration = experiment.duration.value_or(experiment.tick);
  const TimeNs rest = duration % experiment.tick;
  if (duration <= 0) {
    faults.add(where, with_code(Code::out_of_bounds,
                                "key 'duration': a run of {} does nothing; write for example "
                                "{}, or leave it out: then the run goes on until it is stopped",
                                format_time(duration), format_time(experiment.tick)));
  } else if (rest != 0) {
    const TimeNs below = duration - rest;
    faults.add(where,
               with_code(Code::off_grid,
                         "key 'duration': {} is not a whole number of ticks of {}; write {}{}",
                         format_time(duration), format_time(experiment.tick),
                         below > 0 ? format_time(below) + " or " : "",
                         format_time(below + experiment.tick)));
  }
}

/// It names the run folder and the node of ROS.
void check_name(const Parameters& keys, const std::string& name, Faults& faults) {
  constexpr std::size_t kLongest = 100;
  const bool plain = std::ranges::all_of(
      name, [](unsigned char c) { return std::isalnum(c) != 0 || c == '_' || c == '-'; });
  if (keys.given("experiment") && (!plain || name.size() > kLongest)) {
    faults.add(keys.where("experiment"),
               with_code(Code::invalid_name,
                         "key 'experiment': '{}' is not a valid experiment name; write up to {} "
                         "letters, digits, '_' and '-'",
                         name, kLongest));
  }
}

void take_keys(const ExperimentFile& file, const Parameters& keys, Experiment& experiment,
               Faults& faults) {
  read_times(keys, experiment, faults);
  const std::string& name = keys.text("experiment");
  experiment.name = name.empty() ? std::filesystem::path(file.path).stem().string() : name;
  check_name(keys, name, faults);
  experiment.seed = static_cast<std::uint64_t>(keys.integer("seed"));
  experiment.sync = sync_named(keys.text("sync"));
  experiment.real_time_factor = keys.number("real_time_factor");
  experiment.ros = ros_named(keys.text("ros"));
}

/// A fault in one key leaves the others' checks alone: its default stands in.
Parameters read_keys(const ExperimentFile& file, Experiment& experiment, Faults& faults) {
  const std::size_t before = faults.count();
  const Parameters keys = resolve_keys(
      experiment_parameters(), {file.keys, "experiment", {file.path, 0, 0}, {}, {}}, {}, faults);
  take_keys(file, keys, experiment, faults);
  if (faults.count() == before) {
    check_duration(where_of(file, "duration"), experiment, faults);
  }
  experiment.sync_where = where_of(file, "sync");
  return keys;
}

std::optional<Camera> camera_of(const Parameters& robot) {
  if (robot.entries("camera").empty()) {
    return std::nullopt;
  }
  const Parameters& keys = robot.map("camera");
  return Camera{static_cast<std::uint32_t>(keys.integer("width")),
                static_cast<std::uint32_t>(keys.integer("height")), keys.number("rate"),
                keys.number("fov")};
}

/// What the robot's messages give its sensors; empty when that is not known.
SensorWidth read_robot(const ExperimentFile& file, const Overrides& overrides,
                       const LookAtRobot& look_at_robot, Experiment& experiment, Faults& faults) {
  if (overrides.replay) {
    if (!overrides.replay->bag.empty()) {
      experiment.robot = {.where = {file.path, 0, 0}, .bag = overrides.replay->bag};
    }
    experiment.ros = Ros::none;
    return {};
  }
  if (!file.robot) {
    return {};
  }
  const std::size_t before = faults.count();
  const ExperimentNode& robot = *file.robot;
  if (robot.keys.contains("bag")) {
    read_bag_keys(robot, directory_of(experiment.origin), experiment, faults);
    return {};
  }
  auto declared = robot_parameters();
  declared.front().default_value.reset();  // one of simulator and bag must be there
  const Parameters keys = resolve_keys(
      declared, {robot.keys, "robot", robot.where, robot.unread, robot.places}, {}, faults);
  const std::string& world = keys.text("world");
  const auto beside = std::filesystem::path(directory_of(experiment.origin)) / world;
  const bool own_seed = keys.given("seed");
  experiment.robot = {std::filesystem::exists(beside) ? beside.string() : world,
                      own_seed ? static_cast<std::uint64_t>(keys.integer("seed")) : experiment.seed,
                      robot.where,
                      {},
                      camera_of(keys)};
  SensorWidth width;
  if (look_at_robot && faults.count() == before) {
    faults.attempt(keys.given("world") ? keys.where("world") : robot.where,
                   [&] { width = look_at_robot(*experiment.robot, dialect_of(experiment.ros)); });
  }
  return width;
}

/// Ways to run that exclude each other.
void check_ways(const Experiment& experiment, Faults& faults) {
  if (experiment.ros != Ros::none) {
    return;
  }
  if (experiment.sync == Sync::sim_time) {
    faults.add(
        experiment.sync_where,
        with_code(Code::conflicting_keys,
                  "key 'sync': sim_time follows the topic /clock, and there is no ROS; write  "
                  "ros: 2,  or  sync: lockstep  for the robot in this process"));
  } else if (experiment.sync == Sync::lockstep && !experiment.robot) {
    faults.add(experiment.sync_where,
               with_code(Code::conflicting_keys,
                         "key 'sync': lockstep has no robot to step; write  robot: "
                         "{simulator: mujoco},  ros: 2  for a robot that can be stepped "
                         "(docs/stepping.md), or  sync: unpaced"));
  }
}

constexpr const char* kImageTopic = "/camera/image_raw";
constexpr const char* kInfoTopic = "/camera/camera_info";

/// What the robot in this process sends and takes.
struct RobotTopic {
  const char* kind;
  const char* topic;
  const char* message;
};
constexpr RobotTopic kRobotTopics[] = {{kRosSensor, "/scan", "sensor_msgs/LaserScan"},
                                       {kRosSensor, "/odom", "nav_msgs/Odometry"},
                                       {kRosSensor, "/imu", "sensor_msgs/Imu"},
                                       {kRosSensor, "/joint_states", "sensor_msgs/JointState"},
                                       {kRosSensor, "/tf", "tf2_msgs/TFMessage"},
                                       {kRosSensor, "/tf_static", "tf2_msgs/TFMessage"},
                                       {kRosSensor, "/light", "std_msgs/Float64MultiArray"},
                                       {kRosSensor, kImageTopic, "sensor_msgs/Image"},
                                       {kRosSensor, kInfoTopic, "sensor_msgs/CameraInfo"},
                                       {kRosCommand, "/cmd_vel", "geometry_msgs/Twist"}};

void check_robot_topic(const Node& node, const Experiment& experiment) {
  if (!experiment.robot) {
    throw ConfigurationError(node.where,
                             with_code(Code::no_such_topic,
                                       "node '{}': no robot provides topic {}; write  ros: 2, "
                                       "or  robot: {{simulator: mujoco}}",
                                       node.name, node.parameters.text("topic")));
  }
  if (!experiment.robot->bag.empty()) {
    return;  // check_bag()
  }
  const std::string& topic = node.parameters.text("topic");
  if (node.kind == kRosEventSensor) {
    throw ConfigurationError(
        node.parameters.where("topic"),
        with_code(Code::no_such_topic,
                  "key 'topic': the robot in this process has no event camera that sends {}; "
                  "write  ros: 2  for one that has, or take the changes of its pictures "
                  "(docs/images.md, \"Events from frames\")",
                  topic));
  }
  std::vector<std::string> known;
  for (const RobotTopic& robot : kRobotTopics) {
    if (node.kind != robot.kind) {
      continue;
    }
    known.emplace_back(robot.topic);
    if (topic != robot.topic) {
      continue;
    }
    if ((topic == kImageTopic || topic == kInfoTopic) && !experiment.robot->camera) {
      throw ConfigurationError(
          node.parameters.where("topic"),
          with_code(Code::no_such_topic,
                    "key 'topic': the robot's camera, which sends {}, is off; write  robot: "
                    "{{simulator: mujoco, camera: {{width: 64, height: 48}}}}",
                    topic));
    }
    const std::string& message = node.parameters.text("message");
    if (message == robot.message) {
      return;
    }
    throw ConfigurationError(
        node.parameters.where("message"),
        with_code(Code::wrong_message,
                  "key 'message': the robot's topic {} carries {}, not {}; write  message: {}",
                  topic, robot.message, message, robot.message));
  }
  throw ConfigurationError(node.parameters.where("topic"),
                           with_code(Code::no_such_topic,
                                     "key 'topic': the robot has no topic {} there{}; with  ros: "
                                     "2  any topic is possible",
                                     topic, did_you_mean(topic, known)));
}

/// The robot would obey both in turn.
void check_one_sender_a_topic(const Experiment& experiment, const std::set<std::string>& whole,
                              Faults& faults) {
  std::map<std::string, std::string> senders;
  for (const Node& node : experiment.nodes) {
    if (node.kind != kRosCommand || !whole.contains(node.name)) {
      continue;
    }
    const std::string& topic = node.parameters.text("topic");
    const auto [sender, is_new] = senders.emplace(topic, node.name);
    if (!is_new) {
      faults.add(node.parameters.where("topic"),
                 with_code(Code::topic_conflict,
                           "key 'topic': '{}' and '{}' both send to {}, and the robot would obey "
                           "both in turn; write one node with all fields, or another topic",
                           sender->second, node.name, topic));
    }
  }
}

/// A node whose topic is not one of the robot's is no longer `whole`.
void check_topics(const Experiment& experiment, std::set<std::string>& whole, Faults& faults) {
  check_one_sender_a_topic(experiment, whole, faults);
  for (const Node& node : experiment.nodes) {
    if (has_topic(node.kind) && whole.contains(node.name) && experiment.ros == Ros::none &&
        !faults.attempt(node.where, [&] { check_robot_topic(node, experiment); })) {
      whole.erase(node.name);
    }
  }
}

}  // namespace

Sync sync_named(std::string_view name) {
  for (const Sync sync : {Sync::unpaced, Sync::lockstep, Sync::sim_time}) {
    if (name_of(sync) == name) {
      return sync;
    }
  }
  return Sync::realtime;
}

Ros ros_named(std::string_view name) {
  return name == "1" ? Ros::ros1 : name == "2" ? Ros::ros2 : Ros::none;
}

std::string name_of(Ros ros) {
  return ros == Ros::none ? "none" : ros == Ros::ros1 ? "1" : "2";
}

messages::Dialect dialect_of(Ros ros) {
  return ros == Ros::ros2 ? messages::Dialect::ros2 : messages::Dialect::ros1;
}

std::string_view name_of(Sync sync) {
  switch (sync) {
    case Sync::realtime:
      return "realtime";
    case Sync::unpaced:
      return "unpaced";
    case Sync::lockstep:
      return "lockstep";
    case Sync::sim_time:
      break;
  }
  return "sim_time";
}

std::string directory_of(const std::string& experiment_path) {
  const auto parent = std::filesystem::path(experiment_path).parent_path();
  return parent.empty() ? "." : parent.string();
}

const Node& Experiment::node(std::string_view wanted) const {
  for (const Node& candidate : nodes) {
    if (candidate.name == wanted) {
      return candidate;
    }
  }
  throw std::logic_error("there is no such node");
}

std::uint32_t Experiment::width(std::string_view node, std::string_view port) const {
  const std::string end = fmt::format("{}.{}", node, port);
  for (const Connection& connection : connections) {
    if (connection.from == end || connection.to == end) {
      return connection.width;
    }
  }
  return 0;
}

Experiment resolve(const ExperimentFile& file, const NodeTypes& types, const Overrides& overrides,
                   Diagnostics& faults, const LookAtRobot& look_at_robot) {
  Faults all(faults);
  Experiment experiment;
  experiment.path = file.path;
  experiment.origin = origin_of(file, overrides);
  experiment.settings = overrides.settings;
  const Parameters keys = read_keys(file, experiment, all);
  SensorWidth sensor_width = read_robot(file, overrides, look_at_robot, experiment, all);
  const auto bag = open_bag(experiment, all);
  if (bag) {
    sensor_width = bag_width(bag);
  }
  check_ways(experiment, all);
  bool joined = file.joined;
  std::set<std::string> whole;
  const std::string directory = directory_of(experiment.origin);
  for (const ExperimentNode& entry : file.nodes) {
    const Checked checked = resolve_node(entry, types, directory, experiment, all);
    joined = joined && checked.ports;
    if (checked.parameters) {
      whole.insert(entry.name);
    }
  }
  check_topics(experiment, whole, all);
  if (bag && !overrides.replay) {
    check_bag(*bag, whole, experiment, all);
  }
  if (joined) {
    const std::size_t before = all.count();
    const ExperimentFile named = with_simulator_ports(file, experiment, all);
    if (all.count() == before) {
      resolve_connections(named, {whole, overrides.try_nodes, sensor_width}, experiment, all);
    }
  } else if (!faults.empty() && std::ranges::all_of(faults, [](const Diagnostic& fault) {
               return fault.exit_code == 0;  // code that was not run
             })) {
    all.add(
        NotRun("connections are not checked: the ports of a node of code are known when it runs"));
  }
  resolve_layout(keys, file.joined, experiment, all);
  std::ranges::stable_sort(faults, {}, [](const Diagnostic& fault) {
    return std::pair(fault.where.line, fault.where.column);
  });
  return experiment;
}

}  // namespace spikeloop::experiment
