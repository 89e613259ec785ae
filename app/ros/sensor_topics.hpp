// The topics whose silence stops the robot of a ros_command_adapter.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "spikeloop/command/command_settings.hpp"
#include "spikeloop/core/endpoint.hpp"
#include "spikeloop/core/parameters.hpp"
#include "spikeloop/messages/dialect.hpp"
#include "spikeloop/topics/session.hpp"

namespace spikeloop {

ParameterDescription sensor_topics_parameter();

/// A topic whose messages must not stop coming.
struct SensorTopic {
  command::WatchedSensor sensor;
  std::string message_type;
};
/// The key `sensor_topics`. @throws ConfigurationError at the key.
std::vector<SensorTopic> sensor_topics(const Parameters& keys, messages::Dialect ros);

/// Port: `out` [1], the monotonic time in s at which the newest message arrived.
/// @throws ConfigurationError for an unknown type or an invalid topic.
std::unique_ptr<Source> arrivals(topics::Session& session, const SensorTopic& topic);

}  // namespace spikeloop
