// What the keys of endpoints mean, for whoever makes them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "spikeloop/config/mapping_file.hpp"
#include "spikeloop/core/endpoint.hpp"
#include "spikeloop/core/parameters.hpp"
#include "spikeloop/experiment/experiment.hpp"
#include "spikeloop/messages/event_conversion.hpp"
#include "spikeloop/messages/sensor_rule.hpp"

namespace spikeloop::experiment {

/// `fields` and `image` of a ros_sensor. @throws ConfigurationError as sensing::sensor_rule.
messages::SensorRule sensor_rule(const Parameters& parameters);
/// `initial` of a ros_sensor. @throws ConfigurationError when it is neither a number nor none.
std::optional<double> sensor_initial(const Parameters& parameters);
/// What a ros_event_sensor takes; port and place are left to the caller. @throws
/// ConfigurationError: `roi` is no region, `message` has no events.
messages::EventSettings event_settings(const Parameters& parameters);
/// Channels that the camera of a message takes of a ros_event_sensor; 0: it cannot be read.
std::uint32_t count_channels(const Parameters& parameters, std::span<const std::byte> message);
/// Number of values that a message gives a ros_sensor; 0: as many as are asked for, or it cannot be
/// read.
std::uint32_t count_values(const Parameters& parameters, std::span<const std::byte> message);
/// @throws ConfigurationError at the field that the message does not have.
void check_command_fields(const CommandMapping& mapping, messages::Dialect ros);

/// The source of a playback, as wide as its recording, which resolve() has held against the
/// connections. @throws FileError, ConfigurationError: no such file or stream.
std::unique_ptr<Source> playback(const Part& part);

}  // namespace spikeloop::experiment
