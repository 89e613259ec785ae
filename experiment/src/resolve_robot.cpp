// The key `robot`, and the topics of the nodes against those of the robot.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <set>

#include "faults.hpp"
#include "spikeloop/config/experiment_file.hpp"
#include "spikeloop/config/network_script.hpp"
#include "spikeloop/core/code.hpp"
#include "spikeloop/core/files_read.hpp"
#include "spikeloop/experiment/endpoints.hpp"

namespace spikeloop::experiment {
namespace {

/// A file beside the experiment; else a name of a shipped one.
std::string beside(const std::string& directory, const std::string& name) {
  const auto path = std::filesystem::path(directory) / name;
  return std::filesystem::exists(path) ? path.string() : name;
}

std::optional<Camera> camera_of(const Parameters& robot) {
  if (robot.entries("camera").empty()) {
    return std::nullopt;
  }
  const Parameters& keys = robot.map("camera");
  return Camera{keys.text("name"), static_cast<std::uint32_t>(keys.integer("width")),
                static_cast<std::uint32_t>(keys.integer("height")), keys.number("rate"),
                keys.number("fov")};
}

void refuse(const Parameters& keys, std::initializer_list<const char*> names,
            const std::string& reason, Faults& faults) {
  for (const char* const name : names) {
    if (keys.given(name)) {
      faults.add(keys.where(name),
                 with_code(Code::conflicting_keys, "robot: key '{}' {}", name, reason));
    }
  }
}

/// A robot is the vehicle in a world, any other that a model describes, or an environment.
void check_kind(const Parameters& keys, Faults& faults) {
  if (keys.given("environment")) {
    if (keys.text("environment") != "frozen_lake") {
      refuse(keys, {"slippery"}, "is for frozen_lake; leave it out", faults);
    }
    refuse(keys, {"simulator", "world", "model", "keyframe", "rate", "camera"},
           "is for a robot in MuJoCo, and 'environment' replaces it; leave one of the two out",
           faults);
    return;
  }
  refuse(keys, {"step", "slippery"},
         "is for an environment; leave it out, or write for example  environment: frozen_lake",
         faults);
  if (keys.given("model")) {
    refuse(keys, {"world", "seed"},
           "is for the vehicle, and 'model' replaces it; leave one of the two out", faults);
  } else {
    refuse(keys, {"keyframe", "rate"}, "is for a robot with  model: FILE; leave it out", faults);
  }
}

std::optional<RobotModel> model_of(const Parameters& keys, const std::string& directory) {
  if (!keys.given("model")) {
    return std::nullopt;
  }
  return RobotModel{beside(directory, keys.text("model")), keys.text("keyframe"),
                    keys.number("rate")};
}

std::optional<Environment> environment_of(const Parameters& keys, const std::string& directory,
                                          Faults& faults) {
  if (!keys.given("environment")) {
    return std::nullopt;
  }
  Environment environment{keys.text("environment"), keys.boolean("slippery")};
  if (is_network_script(environment.name)) {
    environment.name = in_directory(directory, environment.name);
    const std::string file = network_source(environment.name);
    if (std::filesystem::exists(file)) {
      FilesRead::note(file);
    } else {
      faults.attempt(keys.where("environment"), [&] {
        refuse_file("environment", keys.where("environment"), "Python file", file);
      });
    }
  }
  if (keys.given("step")) {
    environment.step = from_seconds(keys.number("step"));
  }
  return environment;
}

/// Its messages come at ticks, and it is stepped in this process.
void check_environment(const Parameters& keys, const RobotView& view, const Experiment& experiment,
                       Faults& faults) {
  const Location& where = keys.where("environment");
  if (experiment.ros != Ros::none) {
    faults.add(where, with_code(Code::conflicting_keys,
                                "robot: an environment has no topics of ROS; leave  ros  out"));
  }
  if (view.step % experiment.tick != 0) {
    faults.add(keys.given("step") ? keys.where("step") : where,
               with_code(Code::off_grid,
                         "robot: a step of the environment, {}, is not a whole number of ticks of "
                         "{}; write another  step  or  tick",
                         format_time(view.step), format_time(experiment.tick)));
  }
}

}  // namespace

RobotView read_robot(const ExperimentFile& file, const Overrides& overrides,
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
  auto& simulator = declared.front().default_value;
  simulator.reset();  // one of simulator, environment and bag must be there
  if (robot.keys.contains("environment")) {
    simulator = "mujoco";
  }
  const Parameters keys = resolve_keys(
      declared, {robot.keys, "robot", robot.where, robot.unread, robot.places}, {}, faults);
  const std::string directory = directory_of(experiment.origin);
  const bool own_seed = keys.given("seed");
  check_kind(keys, faults);
  experiment.robot = {beside(directory, keys.text("world")),
                      own_seed ? static_cast<std::uint64_t>(keys.integer("seed")) : experiment.seed,
                      robot.where,
                      {},
                      camera_of(keys),
                      model_of(keys, directory),
                      environment_of(keys, directory, faults)};
  RobotView view;
  if (look_at_robot && faults.count() == before) {
    const char* const key = keys.given("environment") ? "environment"
                            : keys.given("model")     ? "model"
                                                      : "world";
    faults.attempt(keys.given(key) ? keys.where(key) : robot.where,
                   [&] { view = look_at_robot(experiment); });
  }
  if (experiment.robot->environment) {
    check_environment(keys, view, experiment, faults);
  }
  return view;
}

namespace {

constexpr const char* kImageTopic = "/camera/image_raw";
constexpr const char* kInfoTopic = "/camera/camera_info";

/// Topics of robots that are otherwise made: which one is meant, and how to get it.
[[noreturn]] void refuse_topic(const Node& node, const Robot& robot,
                               const std::vector<std::string>& known) {
  const std::string& topic = node.parameters.text("topic");
  const Location& where = node.parameters.where("topic");
  if (node.kind == kRosSensor && (topic == kImageTopic || topic == kInfoTopic)) {
    throw ConfigurationError(
        where, with_code(Code::no_such_topic,
                         "key 'topic': the robot's camera, which sends {}, is off; write  robot: "
                         "{{simulator: mujoco, camera: {{width: 64, height: 48}}}}",
                         topic));
  }
  if (node.kind == kRosSensor && (topic == "/light" || topic == "/lane") && !robot.model) {
    const bool light = topic == "/light";
    throw ConfigurationError(
        where,
        with_code(Code::no_such_topic,
                  "key 'topic': the robot sends nothing on {} in this world, which has no "
                  "{}; write  world: {}, or give yours {} (docs/robot.md)",
                  topic, light ? "lamps" : "lanes", light ? "phototaxis  or  t_maze" : "lane",
                  light ? "sites lamp_*" : "boxes lane_*"));
  }
  throw ConfigurationError(
      where, with_code(Code::no_such_topic,
                       "key 'topic': the robot has no topic {} there{}; with  ros: 2  any topic "
                       "is possible",
                       topic, did_you_mean(topic, known)));
}

/// "; did you mean ...?", with the robot's field of the same joint if there is one.
std::string meant_field(const std::string& field, const std::vector<std::string>& known) {
  const auto bracket = std::min(field.find('['), field.size());
  const auto same = std::ranges::find_if(known, [&](const std::string& candidate) {
    return bracket < field.size() && candidate.ends_with(field.substr(bracket));
  });
  return same == known.end() ? did_you_mean(field, known)
                             : fmt::format("; did you mean '{}'?", *same);
}

/// A joint or actuator that a command names.
void check_fields(const Node& node, const RobotTopic& topic) {
  for (const CommandField& field : node.mapping.fields) {
    if (std::ranges::find(topic.fields, field.field) == topic.fields.end()) {
      throw ConfigurationError(
          field.where,
          with_code(Code::field_path, "the robot does not use the field '{}' of its topic {}{}",
                    field.field, topic.name, meant_field(field.field, topic.fields)));
    }
  }
}

/// The measured positions that a stop holds.
void check_held_joints(const Node& node, const std::vector<RobotTopic>& topics) {
  const auto named = std::ranges::find_if(
      node.mapping.fields, [](const CommandField& field) { return !field.held_joint().empty(); });
  const std::string& written = node.parameters.text("joint_states");
  if (named == node.mapping.fields.end() || written == "none") {
    return;
  }
  std::vector<std::string> known;
  std::vector<std::string> joints;
  for (const RobotTopic& topic : topics) {
    if (!topic.joints.empty()) {
      known.push_back(topic.name);
      joints = written.empty() || topic.name == written ? topic.joints : joints;
    }
  }
  if (!written.empty() && std::ranges::find(known, written) == known.end()) {
    throw ConfigurationError(node.parameters.where("joint_states"),
                             with_code(Code::no_such_topic,
                                       "key 'joint_states': the robot sends no joint positions on "
                                       "{}{}",
                                       written, did_you_mean(written, known)));
  }
  for (const CommandField& field : node.mapping.fields) {
    const std::string joint = field.held_joint();
    if (!joint.empty() && std::ranges::find(joints, joint) == joints.end()) {
      throw ConfigurationError(
          node.parameters.where(node.parameters.given("stop") ? "stop" : "fields"),
          with_code(Code::field_path, "key 'stop': the robot has no joint '{}' to hold{}", joint,
                    did_you_mean(joint, joints)));
    }
  }
}

/// Null when the robot does not have it.
const RobotTopic* topic_of(const Node& node, const std::vector<RobotTopic>& topics) {
  const auto topic = std::ranges::find_if(topics, [&](const RobotTopic& candidate) {
    return candidate.name == node.parameters.text("topic") &&
           candidate.takes_commands() == (node.kind == kRosCommand);
  });
  return topic == topics.end() ? nullptr : &*topic;
}

void check_message(const Node& node, const RobotTopic& topic) {
  const std::string& message = node.parameters.text("message");
  if (message != topic.message) {
    throw ConfigurationError(
        node.parameters.where("message"),
        with_code(Code::wrong_message,
                  "key 'message': the robot's topic {} carries {}, not {}; write  message: {}",
                  topic.name, topic.message, message, topic.message));
  }
}

/// Over ROS other topics may belong to other nodes.
void check_topic_over_ros(const Node& node, const std::vector<RobotTopic>& topics) {
  if (const RobotTopic* const topic = topic_of(node, topics)) {
    check_message(node, *topic);
  }
}

void check_robot_topic(const Node& node, const Experiment& experiment,
                       const std::vector<RobotTopic>& topics) {
  if (!experiment.robot) {
    throw ConfigurationError(node.where,
                             with_code(Code::no_such_topic,
                                       "node '{}': no robot provides topic {}; write  ros: 2, "
                                       "or  robot: {{simulator: mujoco}}",
                                       node.name, node.parameters.text("topic")));
  }
  if (!experiment.robot->bag.empty() || topics.empty()) {
    return;  // check_bag(), or not known
  }
  const std::string& name = node.parameters.text("topic");
  if (node.kind == kRosEventSensor) {
    throw ConfigurationError(
        node.parameters.where("topic"),
        with_code(Code::no_such_topic,
                  "key 'topic': the robot in this process has no event camera that sends {}; "
                  "write  ros: 2  for one that has, or take the changes of its pictures "
                  "(docs/images.md, \"Events from frames\")",
                  name));
  }
  std::vector<std::string> known;
  for (const RobotTopic& topic : topics) {
    if (topic.takes_commands() == (node.kind == kRosCommand)) {
      known.push_back(topic.name);
    }
  }
  const RobotTopic* const topic = topic_of(node, topics);
  if (topic == nullptr) {
    refuse_topic(node, *experiment.robot, known);
  }
  check_message(node, *topic);
  if (topic->takes_commands()) {
    if (experiment.robot->model) {
      check_fields(node, *topic);
    }
    check_held_joints(node, topics);
  }
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

}  // namespace

void check_topics(const Experiment& experiment, const std::vector<RobotTopic>& topics,
                  std::set<std::string>& whole, Faults& faults) {
  check_one_sender_a_topic(experiment, whole, faults);
  for (const Node& node : experiment.nodes) {
    if (!has_topic(node.kind) || !whole.contains(node.name)) {
      continue;
    }
    const auto check = [&] {
      if (experiment.ros == Ros::none) {
        check_robot_topic(node, experiment, topics);
      } else {
        check_topic_over_ros(node, topics);
      }
    };
    if (!faults.attempt(node.where, check)) {
      whole.erase(node.name);
    }
  }
}

}  // namespace spikeloop::experiment
