// What the keys of endpoints mean, for whoever makes them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "spikeloop/config/mapping_file.hpp"
#include "spikeloop/core/endpoint.hpp"
#include "spikeloop/core/parameters.hpp"
#include "spikeloop/experiment/experiment.hpp"
#include "spikeloop/messages/event_conversion.hpp"
#include "spikeloop/topics/event_sensor.hpp"
#include "spikeloop/topics/sensor.hpp"

namespace spikeloop::experiment {

/// A ros_sensor; the port's width is left to the caller. @throws ConfigurationError as
/// sensing::sensor_rule,
/// and when `initial` is neither a number nor none.
topics::SensorSettings sensor_settings(const Parameters& parameters);
/// True if a ros_sensor reads the pixels of an image. An image of another size than the port is an
/// error; other messages may have any number of values.
bool takes_picture(const Parameters& parameters);
/// What a ros_event_sensor takes; port and place are left to the caller. @throws
/// ConfigurationError: `roi` is not a region, `message` has no events.
messages::EventSettings event_settings(const Parameters& parameters);
/// A ros_event_sensor; port and place are left to the caller. @throws as event_settings.
topics::EventSensorSettings event_sensor_settings(const Parameters& parameters);
/// Number of channels that a ros_sensor or ros_event_sensor has for this message. 0: the message
/// has no value.
/// @throws ConfigurationError as in a run: keys that do not fit the message type or the message;
/// TransportError if the message cannot be read
std::uint32_t count_channels(const Node& sensor, messages::Dialect ros,
                             std::span<const std::byte> message);

/// The whole name of a message type that has a definition, or the whole path of its own.
/// @throws ConfigurationError for one that this ROS does not have.
std::string whole_message_type(const std::string& written, const std::string& directory,
                               messages::Dialect ros);
/// A topic's node: its message gets its whole name; a command its mapping, unless it has one.
/// @param directory where the path of a message definition starts
/// @throws ConfigurationError for what its message, or a topic of this ROS, does not have.
void read_endpoint(Node& node, const std::string& directory, messages::Dialect ros);

/// The source of a playback, as wide as its recording, which resolve() has held against the
/// connections. @throws FileError, ConfigurationError: no such file or stream.
std::unique_ptr<Source> playback(const Node& node);

}  // namespace spikeloop::experiment
