// The keys of ros_command_adapter that bound a command, and that say who else stops the robot.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "spikeloop/command/command_sink.hpp"
#include "spikeloop/config/mapping_file.hpp"
#include "spikeloop/core/parameters.hpp"
#include "spikeloop/messages/dialect.hpp"

namespace spikeloop {

std::vector<ParameterDescription> safety_parameters();

/// A topic whose messages must not stop coming.
struct SensorTopic {
  command::WatchedSensor sensor;
  std::string message_type;
};
/// The key `sensor_topics`. @throws ConfigurationError at the key.
std::vector<SensorTopic> sensor_topics(const Parameters& keys, messages::Dialect ros);

/// Puts what the keys say into a command's settings.
/// @param topic of the commands
/// @throws ConfigurationError at the key that is wrong.
void add_safety(const Parameters& keys, const CommandMapping& mapping, const std::string& topic,
                messages::Dialect ros, command::CommandSettings& settings);

}  // namespace spikeloop
