// The topic on which a robot takes its commands.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "spikeloop/messages/field_path.hpp"
#include "spikeloop/vehicle/simulation.hpp"

namespace spikeloop::robot {

/// The vehicle takes a geometry_msgs/Twist on cmd_vel. Every other robot takes a
/// sensor_msgs/JointState on joint_commands, with the names of actuators: `position` for a
/// <position>, `velocity` for a <velocity>, `effort` for every other one.
class CommandTopic {
 public:
  CommandTopic(const vehicle::Simulation& robot, messages::Dialect dialect);

  const std::string& name() const { return name_; }
  const std::string& type() const { return type_; }
  /// Paths of the fields that it reads: "linear.x", "effort[name=elbow]".
  std::vector<std::string> fields() const;
  /// Numbers for Simulation::command(); NaN for a field that the message does not have.
  /// @throws TransportError when the message is too short.
  std::vector<double> read(std::span<const std::byte> message) const;

 private:
  std::string name_;
  std::string type_;
  std::vector<messages::FieldReader> readers_;
};

}  // namespace spikeloop::robot
