#include "endpoints.hpp"

#include <algorithm>
#include <utility>

#include "spikeloop/command/command_settings.hpp"
#include "spikeloop/command/mapping.hpp"
#include "spikeloop/experiment/endpoints.hpp"
#include "spikeloop/experiment/safety.hpp"
#include "spikeloop/topics/event_sensor.hpp"
#include "spikeloop/topics/sensor.hpp"

namespace spikeloop::fused {
namespace {

using command::CommandClock;
using experiment::Connection;
using experiment::Experiment;
using experiment::Node;

/// What both kinds of sensors have in common.
template <typename Settings>
Settings with_transport(Settings settings, Transport& transport, topics::Keep keep) {
  settings.simulated_stamp = transport.clock() != CommandClock::wall;
  if (transport.clock() == CommandClock::lockstep) {
    settings.queue = 0;  // the robot waits until all of its messages are here
  }
  settings.arrived = [&transport] { transport.arrived(); };
  settings.keep = std::move(keep);
  return settings;
}

std::unique_ptr<topics::TopicSource> make_event_sensor(const Node& node, std::uint32_t width,
                                                       Transport& transport, topics::Keep keep) {
  topics::EventSensorSettings settings = experiment::event_sensor_settings(node.parameters);
  settings.node = node.name;
  settings.events.width = width;
  settings.from_begin = transport.clock() == CommandClock::lockstep;
  return std::make_unique<topics::EventSensor>(
      transport.session(node), with_transport(std::move(settings), transport, std::move(keep)));
}

std::unique_ptr<topics::TopicSource> make_signal_sensor(const Node& node, std::uint32_t width,
                                                        Transport& transport, topics::Keep keep) {
  topics::SensorSettings settings = experiment::sensor_settings(node.parameters);
  settings.node = node.name;
  settings.width = width;
  settings.strict = experiment::takes_picture(node.parameters);
  return std::make_unique<topics::Sensor>(
      transport.session(node), with_transport(std::move(settings), transport, std::move(keep)));
}

command::CommandSettings clock_settings(const Experiment& experiment, const Node& node,
                                        const command::ComponentMap& map, CommandClock clock) {
  const Parameters& keys = node.parameters;
  const bool with_data_stamp = experiment::nearest_sensor(experiment, node.name).has_value();
  return clock == CommandClock::wall
             ? command::command_settings(keys, map, keys.number("command_rate"),
                                         {experiment.tick, experiment.real_time_factor},
                                         with_data_stamp)
             : command::simulated_settings(keys, map, clock, with_data_stamp);
}

/// In lockstep the simulator must count the topic of joint states. So the topic is used only if it
/// is a sensor's, is set by `joint_states`, or is published by the robot of the experiment.
void add_stop(const Experiment& experiment, const Node& node, CommandClock clock,
              command::CommandSettings& settings) {
  const std::string sensor = experiment::joint_state_sensor(experiment, node);
  experiment::add_stop(node, sensor, settings);
  const bool named = !sensor.empty() || node.parameters.given("joint_states");
  const bool counted = experiment.robot && experiment.robot->model;
  if (clock == CommandClock::lockstep && !named && !counted) {
    settings.joint_states.clear();
  }
}

/// With the bounds, and all that stops the robot.
command::CommandSettings command_settings(const Experiment& experiment, const Node& node,
                                          const command::ComponentMap& map, CommandClock clock) {
  command::CommandSettings settings = clock_settings(experiment, node, map, clock);
  settings.node = node.name;
  const auto driver = std::ranges::find(experiment.connections, node.name + ".in", &Connection::to);
  settings.driver = driver == experiment.connections.end() ? "" : driver->from;
  experiment::add_bounds(node, settings);
  add_stop(experiment, node, clock, settings);
  settings.sensors = experiment::watched_sensors(experiment, node);
  for (const Connection* connection : watched_spikes(experiment, node)) {
    settings.spike_widths.push_back(connection->width);
  }
  settings.spike_timeout = experiment::spike_timeout(node);
  if (experiment.ros != experiment::Ros::none) {  // else there is nobody to stop it or drive it
    experiment::add_operator_input(node, experiment.dialect, settings);
  }
  return settings;
}

}  // namespace

std::unique_ptr<topics::TopicSource> make_sensor(const Experiment& experiment, const Node& node,
                                                 Transport& transport, topics::Keep keep) {
  const std::uint32_t width = experiment.width(node.name, "out");
  auto sensor = node.kind == experiment::kRosEventSensor
                    ? make_event_sensor(node, width, transport, std::move(keep))
                    : make_signal_sensor(node, width, transport, std::move(keep));
  transport.add(node.parameters.text("topic"), *sensor);
  return sensor;
}

std::unique_ptr<ros_command::CommandEndpoint> make_command(const Experiment& experiment,
                                                           const Node& node,
                                                           const command::ComponentMap& map,
                                                           Transport& transport,
                                                           topics::Keep keep) {
  const ros_command::Address address{node.name, node.parameters.text("topic"),
                                     node.mapping.message_type, command::field_paths(node.mapping)};
  auto command = std::make_unique<ros_command::CommandEndpoint>(
      transport.session(node), address, command_settings(experiment, node, map, transport.clock()),
      std::move(keep));
  transport.add(address.topic, *command);
  return command;
}

}  // namespace spikeloop::fused
