#include "spikeloop/robot/command_topic.hpp"

#include <fmt/format.h>

#include <limits>

#include "spikeloop/robot/messages.hpp"

namespace spikeloop::robot {
namespace {

std::string field_of(const vehicle::Actuator& actuator) {
  using vehicle::Quantity;
  const char* const field = actuator.quantity == Quantity::position   ? "position"
                            : actuator.quantity == Quantity::velocity ? "velocity"
                                                                      : "effort";
  return fmt::format("{}[name={}]", field, actuator.name);
}

}  // namespace

CommandTopic::CommandTopic(const vehicle::Simulation& robot, messages::Dialect dialect) {
  const messages::Catalog& catalog = messages::Catalog::builtin(dialect);
  if (robot.vehicle() != nullptr) {
    name_ = "cmd_vel";
    type_ = kTwistType;
    readers_.emplace_back(catalog, type_, "linear.x");
    readers_.emplace_back(catalog, type_, "angular.z");
    return;
  }
  name_ = "joint_commands";
  type_ = kJointStateType;
  for (const vehicle::Actuator& actuator : robot.actuators()) {
    readers_.emplace_back(catalog, type_, field_of(actuator));
  }
}

std::vector<std::string> CommandTopic::fields() const {
  std::vector<std::string> fields;
  for (const messages::FieldReader& reader : readers_) {
    fields.push_back(reader.path().text);
  }
  return fields;
}

std::vector<double> CommandTopic::read(std::span<const std::byte> message) const {
  std::vector<double> numbers;
  for (const messages::FieldReader& reader : readers_) {
    if (reader.read(message, numbers) == 0) {
      numbers.push_back(std::numeric_limits<double>::quiet_NaN());
    }
  }
  return numbers;
}

}  // namespace spikeloop::robot
