#include "spikeloop/fused/robot_sensors.hpp"

#include <map>
#include <span>
#include <utility>

#include "spikeloop/experiment/endpoints.hpp"
#include "spikeloop/robot/messages.hpp"
#include "spikeloop/vehicle/vehicle.hpp"

namespace spikeloop::fused {
namespace {

using Topic = std::pair<std::string, std::string>;  // its name and type
using Bytes = std::vector<std::byte>;

Bytes copied(std::span<const std::byte> message) {
  return {message.begin(), message.end()};
}

}  // namespace

experiment::SensorWidth look_at_robot(const experiment::Robot& robot) {
  const vehicle::Vehicle vehicle({robot.world, robot.seed});
  robot::ScanMessage scan(messages::Dialect::ros1);
  robot::OdometryMessage odometry(messages::Dialect::ros1);
  const std::map<Topic, Bytes> messages{
      {{"/scan", robot::kScanType}, copied(scan.write(vehicle.scan()))},
      {{"/odom", robot::kOdometryType}, copied(odometry.write(vehicle.odometry()))}};
  return [messages](const experiment::Part& sensor) -> std::uint32_t {
    const Parameters& keys = sensor.parameters;
    const auto message = messages.find({keys.text("topic"), keys.text("message")});
    return message == messages.end() ? 0 : experiment::count_values(keys, message->second);
  };
}

}  // namespace spikeloop::fused
