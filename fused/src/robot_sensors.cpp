#include "spikeloop/fused/robot_sensors.hpp"

#include <fmt/format.h>

#include <map>
#include <span>
#include <utility>

#include "make_robot.hpp"
#include "spikeloop/core/code.hpp"
#include "spikeloop/core/error.hpp"
#include "spikeloop/experiment/endpoints.hpp"
#include "spikeloop/messages/field_path.hpp"

namespace spikeloop::fused {
namespace {

using Topic = std::pair<std::string, std::string>;  // its name and type
using Bytes = std::vector<std::byte>;

std::string whole(const std::string& topic) {
  return topic.starts_with('/') ? topic : "/" + topic;
}

/// A joint that a sensor names and the robot does not have.
void check_joints(const experiment::Node& sensor, messages::Dialect ros, const Bytes& message,
                  const std::vector<std::string>& joints) {
  if (sensor.parameters.text("message") != robot::kJointStateType) {
    return;
  }
  const messages::Catalog& catalog = messages::Catalog::builtin(ros);
  for (const Parameters::Entry& field : sensor.parameters.entries("fields")) {
    const std::string& path = field.values.text("path");
    std::vector<double> values;
    if (messages::FieldReader(catalog, robot::kJointStateType, path).read(message, values) != 0) {
      continue;
    }
    if (path.find('=') == std::string::npos) {
      throw ConfigurationError(
          field.where,
          with_code(Code::field_path, "field path '{}': the robot has {} joints, counted from 0",
                    path, joints.size()));
    }
    const std::string joint = path.substr(path.find('=') + 1, path.find(']') - path.find('=') - 1);
    throw ConfigurationError(
        field.where, with_code(Code::field_path, "field path '{}': the robot has no joint '{}'{}",
                               path, joint, did_you_mean(joint, joints)));
  }
}

std::vector<std::string> joints_of(const robot::Robot& robot) {
  const auto* simulated = dynamic_cast<const robot::SteppedRobot*>(&robot);
  return simulated == nullptr ? std::vector<std::string>{}
                              : simulated->robot().joint_states().names;
}

}  // namespace

experiment::RobotView look_at_robot(const experiment::Experiment& experiment) {
  const messages::Dialect ros = experiment::dialect_of(experiment.ros);
  const auto robot = make_robot(experiment, {.blind = true, .dialect = ros});
  experiment::RobotView view;
  for (const robot::SensorTopic& topic : robot->topics()) {
    view.topics.push_back({whole(topic.name), topic.type});
    if (topic.type == robot::kJointStateType) {
      view.topics.back().joints = joints_of(*robot);
    }
  }
  std::map<Topic, Bytes> messages;
  robot->publish(
      0, [](std::size_t) { return true; },
      [&](std::size_t index, std::span<const std::byte> message) {
        const experiment::RobotTopic& topic = view.topics[index];
        messages[{topic.name, topic.message}] = {message.begin(), message.end()};
      });
  const robot::CommandDescription command = robot->command_description();
  if (!command.fields.empty()) {
    view.topics.push_back({whole(command.name), command.type, command.fields});
  }
  if (const auto* environment = dynamic_cast<const robot::EnvironmentRobot*>(robot.get())) {
    view.step = environment->step();
  }
  view.width = [messages, ros, joints = joints_of(*robot)](
                   const experiment::Node& sensor) -> std::optional<std::uint32_t> {
    const Parameters& keys = sensor.parameters;
    const auto message = messages.find({keys.text("topic"), keys.text("message")});
    if (message == messages.end()) {
      return std::nullopt;
    }
    check_joints(sensor, ros, message->second, joints);
    return experiment::count_channels(sensor, ros, message->second);
  };
  return view;
}

}  // namespace spikeloop::fused
