// Sensors and commands of a graph, whatever carries their messages.
#pragma once

#include <memory>

#include "spikeloop/experiment/experiment.hpp"
#include "spikeloop/fused/transport.hpp"

namespace spikeloop::fused {

/// Of a ros_sensor or a ros_event_sensor. Ports: as topics::Sensor, topics::EventSensor.
/// @throws Error as these.
std::unique_ptr<topics::TopicSource> make_sensor(const experiment::Experiment& experiment,
                                                 const experiment::Node& node, Transport& transport,
                                                 topics::Keep keep);

/// @throws Error as ros_command::CommandEndpoint.
std::unique_ptr<ros_command::CommandEndpoint> make_command(const experiment::Experiment& experiment,
                                                           const experiment::Node& node,
                                                           Transport& transport, topics::Keep keep);

}  // namespace spikeloop::fused
