#include "spikeloop/fused/robot_sensors.hpp"

#include <map>
#include <span>
#include <utility>

#include "spikeloop/experiment/endpoints.hpp"
#include "spikeloop/messages/field_path.hpp"
#include "spikeloop/robot/messages.hpp"
#include "spikeloop/vehicle/vehicle.hpp"

namespace spikeloop::fused {
namespace {

using Topic = std::pair<std::string, std::string>;  // its name and type
using Bytes = std::vector<std::byte>;

Bytes copied(std::span<const std::byte> message) {
  return {message.begin(), message.end()};
}

std::uint32_t count(const Bytes& message, const std::string& type, const Parameters& keys) {
  std::vector<std::string> fields = experiment::sensor_fields(keys);
  if (fields.empty() && type == robot::kScanType) {
    fields = {"ranges"};
  }
  std::vector<double> values;
  for (const std::string& field : fields) {
    messages::FieldReader(messages::Catalog::builtin(), type, field).read(message, values);
  }
  return static_cast<std::uint32_t>(values.size());
}

}  // namespace

experiment::SensorWidth look_at_robot(const experiment::Robot& robot) {
  const vehicle::Vehicle vehicle({robot.world, robot.seed});
  robot::ScanMessage scan;
  robot::OdometryMessage odometry;
  const std::map<Topic, Bytes> messages{
      {{"/scan", robot::kScanType}, copied(scan.write(vehicle.scan()))},
      {{"/odom", robot::kOdometryType}, copied(odometry.write(vehicle.odometry()))}};
  return [messages](const experiment::Part& sensor) -> std::uint32_t {
    const Parameters& keys = sensor.parameters;
    const auto message = messages.find({keys.text("topic"), keys.text("message")});
    try {
      return message == messages.end() ? 0 : count(message->second, message->first.second, keys);
    } catch (const ConfigurationError&) {
      return 0;  // fields that are not there are told of elsewhere
    }
  };
}

}  // namespace spikeloop::fused
