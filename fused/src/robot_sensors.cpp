#include "spikeloop/fused/robot_sensors.hpp"

#include <fmt/format.h>

#include <map>
#include <span>
#include <utility>

#include "robot_options.hpp"
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

}  // namespace

experiment::RobotView look_at_robot(const experiment::Robot& described, messages::Dialect ros) {
  robot::RobotOptions options = robot_options(described);
  options.sensors.blind = true;
  options.sensors.dialect = ros;
  const auto robot = robot::make_robot(options.vehicle, options.model);
  robot::Sensors sensors(*robot, options.sensors);
  const robot::CommandTopic command(*robot, ros);
  experiment::RobotView view;
  std::map<Topic, Bytes> messages;
  for (std::size_t i = 0; i < sensors.topics().size(); ++i) {
    const robot::SensorTopic& topic = sensors.topics()[i];
    const auto message = sensors.write(i, *robot);
    messages[{whole(topic.name), topic.type}] = {message.begin(), message.end()};
    view.topics.push_back({whole(topic.name), topic.type});
  }
  if (!command.fields().empty()) {
    view.topics.push_back({whole(command.name()), command.type(), command.fields()});
  }
  view.width = [messages, ros, joints = robot->joint_states().names](
                   const experiment::Node& sensor) -> std::optional<std::uint32_t> {
    const Parameters& keys = sensor.parameters;
    const auto message = messages.find({keys.text("topic"), keys.text("message")});
    if (message == messages.end()) {
      return std::nullopt;
    }
    check_joints(sensor, ros, message->second, joints);
    return experiment::count_values(keys, ros, message->second);
  };
  return view;
}

}  // namespace spikeloop::fused
