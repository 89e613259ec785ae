#include "spikeloop/fused/robot_sensors.hpp"

#include <map>
#include <span>
#include <utility>

#include "sensor_options.hpp"
#include "spikeloop/experiment/endpoints.hpp"
#include "spikeloop/robot/sensors.hpp"
#include "spikeloop/vehicle/vehicle.hpp"

namespace spikeloop::fused {
namespace {

using Topic = std::pair<std::string, std::string>;  // its name and type
using Bytes = std::vector<std::byte>;

Bytes copied(std::span<const std::byte> message) {
  return {message.begin(), message.end()};
}

}  // namespace

experiment::SensorWidth look_at_robot(const experiment::Robot& robot, messages::Dialect ros) {
  const vehicle::Vehicle vehicle({robot.world, robot.seed});
  robot::SensorOptions options = sensor_options(robot);
  options.blind = true;
  options.dialect = ros;
  robot::Sensors sensors(vehicle, options);
  std::map<Topic, Bytes> messages;
  for (std::size_t i = 0; i < sensors.topics().size(); ++i) {
    const robot::SensorTopic& topic = sensors.topics()[i];
    const std::string name = topic.name.starts_with('/') ? topic.name : "/" + topic.name;
    messages[{name, topic.type}] = copied(sensors.write(i, vehicle));
  }
  return [messages, ros](const experiment::Node& sensor) -> std::optional<std::uint32_t> {
    const Parameters& keys = sensor.parameters;
    const auto message = messages.find({keys.text("topic"), keys.text("message")});
    if (message == messages.end()) {
      return std::nullopt;
    }
    return experiment::count_values(keys, ros, message->second);
  };
}

}  // namespace spikeloop::fused
