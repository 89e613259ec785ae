#include "endpoints.hpp"

#include <algorithm>
#include <utility>

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

command::CommandSettings command_settings(const Experiment& experiment, const Node& node,
                                          CommandClock clock) {
  const std::string states = experiment::joint_state_sensor(experiment, node);
  const auto ros =
      experiment.ros == experiment::Ros::none ? std::nullopt : std::optional(experiment.dialect);
  command::CommandSettings settings = experiment::command_settings(
      node, experiment.width(node.name, "in"),
      {clock, experiment.tick, experiment.real_time_factor}, states, ros);
  // In lockstep the simulator must count the joint states. So the topic is used only if it is a
  // sensor's, is set by `joint_states`, or is published by the robot of the experiment.
  const bool named = !states.empty() || node.parameters.given("joint_states");
  const bool counted = experiment.robot && experiment.robot->model;
  if (clock == CommandClock::lockstep && !named && !counted) {
    settings.joint_states.clear();
  }
  settings.node = node.name;
  const auto driver = std::ranges::find(experiment.connections, node.name + ".in", &Connection::to);
  settings.driver = driver == experiment.connections.end() ? "" : driver->from;
  settings.with_data_stamp = experiment::nearest_sensor(experiment, node.name).has_value();
  settings.sensors = experiment::watched_sensors(experiment, node);
  for (const Connection* connection : watched_spikes(experiment, node)) {
    settings.spike_widths.push_back(connection->width);
  }
  settings.spike_timeout = experiment::spike_timeout(node);
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
                                                           const Node& node, Transport& transport,
                                                           topics::Keep keep) {
  auto command = std::make_unique<ros_command::CommandEndpoint>(
      transport.session(node), command_settings(experiment, node, transport.clock()),
      std::move(keep));
  transport.add(node.parameters.text("topic"), *command);
  return command;
}

}  // namespace spikeloop::fused
