#include "robot_text.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "output.hpp"
#include "spikeloop/robot/command_topic.hpp"
#include "spikeloop/robot/messages.hpp"
#include "spikeloop/robot/sensors.hpp"
#include "spikeloop/vehicle/simulation.hpp"

namespace spikeloop::app {
namespace {

std::string names(const char* title, const std::vector<std::string>& all) {
  return all.empty() ? "" : fmt::format("{}: {}\n", title, fmt::join(all, ", "));
}

std::string topic_line(const std::string& name, const std::string& type, const std::string& text) {
  return fmt::format("  {:<26}  /{:<26}  {}\n", type, name, text);
}

}  // namespace

std::string robot_text(const std::string& file) {
  const vehicle::Simulation robot({file});
  const robot::Sensors sensors(robot, {});
  const robot::CommandTopic command(robot, messages::Dialect::ros1);
  std::string text =
      fmt::format("{0}: write  robot: {{simulator: mujoco, model: {0}}}\n\nTopics:\n", file);
  std::size_t sensor = 0;
  for (const robot::SensorTopic& topic : sensors.topics()) {
    const bool numbers = topic.type == robot::kNumbersType;
    text += topic_line(topic.name, topic.type,
                       numbers ? count_of(robot.sensors()[sensor++].width, "value")
                       : topic.type == robot::kImuType ? "inertial unit"
                                                       : "position, velocity, effort of joints");
  }
  if (!command.fields().empty()) {
    text += topic_line(command.name(), command.type(), "commands for actuators");
  }
  text += "\n" + names("Joints", robot.joint_states().names);
  text += names("Fields for commands", command.fields());
  text += names("Cameras", robot.names_of(vehicle::Named::camera));
  return text + names("Keyframes", robot.names_of(vehicle::Named::keyframe));
}

}  // namespace spikeloop::app
