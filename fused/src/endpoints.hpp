// Sensors and commands of a graph, whatever carries their messages.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "spikeloop/command/component_map.hpp"
#include "spikeloop/experiment/experiment.hpp"
#include "spikeloop/fused/transport.hpp"

namespace spikeloop::fused {

/// Of a ros_sensor or a ros_event_sensor. Ports: as topics::Sensor, topics::EventSensor.
/// @throws Error as these.
std::unique_ptr<topics::TopicSource> make_sensor(const experiment::Experiment& experiment,
                                                 const experiment::Part& part, Transport& transport,
                                                 topics::Keep keep);

/// @param map channels to fields
/// @throws Error as ros_command::CommandEndpoint.
std::unique_ptr<ros_command::CommandEndpoint> make_command(const experiment::Experiment& experiment,
                                                           const experiment::Part& part,
                                                           const command::ComponentMap& map,
                                                           Transport& transport, topics::Keep keep);

/// The connections that a command's spike_timeout speaks of.
std::vector<const experiment::Link*> watched_spikes(const experiment::Experiment& experiment,
                                                    const experiment::Part& command);

/// The sensor whose data reach a node by the least delay, and that delay in ticks.
struct Upstream {
  std::string sensor;
  std::uint32_t delay_ticks = 0;
};
std::optional<Upstream> nearest_sensor(const experiment::Experiment& experiment,
                                       const std::string& node);

}  // namespace spikeloop::fused
