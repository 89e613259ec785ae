// The topics whose silence stops the robot of a ros_command_adapter.
#pragma once

#include <string>
#include <vector>

#include "spikeloop/command/command_sink.hpp"
#include "spikeloop/core/parameters.hpp"
#include "spikeloop/messages/dialect.hpp"

namespace spikeloop {

ParameterDescription sensor_topics_parameter();

/// A topic whose messages must not stop coming.
struct SensorTopic {
  command::WatchedSensor sensor;
  std::string message_type;
};
/// The key `sensor_topics`. @throws ConfigurationError at the key.
std::vector<SensorTopic> sensor_topics(const Parameters& keys, messages::Dialect ros);

}  // namespace spikeloop
