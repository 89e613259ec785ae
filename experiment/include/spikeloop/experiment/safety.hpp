// The keys that limit and stop a robot, and the data behind a command.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "spikeloop/command/command_settings.hpp"
#include "spikeloop/core/parameters.hpp"
#include "spikeloop/experiment/experiment.hpp"

namespace spikeloop::experiment {

using command::kNoLimits;

/// The keys `emergency_stop` and `override` of a ros_command.
ParameterDescription emergency_stop_parameter();
ParameterDescription override_parameter();

/// `emergency_stop` of a ros_command: none, a topic, or a map, whose message is one of this ROS.
/// @throws ConfigurationError.
command::EmergencyStop emergency_stop(const Node& command, messages::Dialect ros);
/// `override` of a ros_command: none, a topic, or a map. @throws ConfigurationError.
command::Override manual_override(const Node& command);
/// Settings of a command, apart from the data behind it.
/// @param width channels of its port
/// @param joint_states topic of a sensor of sensor_msgs/JointState; empty if there is none
/// @param ros nullopt: the robot cannot be stopped or driven over ROS
command::CommandSettings command_settings(const Node& command, std::uint32_t width,
                                          const command::LoopClock& loop,
                                          const std::string& joint_states,
                                          std::optional<messages::Dialect> ros);
/// The topic of the first sensor of sensor_msgs/JointState that a command depends on; empty if
/// there is none.
std::string joint_state_sensor(const Experiment& experiment, const Node& command);
/// 0: the network may be silent.
TimeNs spike_timeout(const Node& command);

/// The sensors that a node depends on through the graph, in the file's order, with the `timeout` of
/// each, or else the command's `sensor_timeout`. A ros_event_sensor is one of them when it has a
/// `timeout`.
std::vector<command::WatchedSensor> watched_sensors(const Experiment& experiment,
                                                    const Node& command);
/// The sensors themselves.
std::vector<const Node*> sensors_behind(const Experiment& experiment, const std::string& node);
/// The connections on which the last spikes on the way to a node travel, in the file's order.
std::vector<const Connection*> spikes_behind(const Experiment& experiment, const std::string& node);
/// Those that a command's `spike_timeout` speaks of.
std::vector<const Connection*> watched_spikes(const Experiment& experiment, const Node& command);

/// The sensor whose data reach a node by the least delay, and that delay in ticks.
struct Upstream {
  std::string sensor;
  std::uint32_t delay_ticks = 0;
};
std::optional<Upstream> nearest_sensor(const Experiment& experiment, const std::string& node);

}  // namespace spikeloop::experiment
