// How files and viewers that are not ROS name a type of messages: the encodings of MCAP
// (https://mcap.dev/spec/registry) and of the Foxglove WebSocket protocol.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>

#include "spikeloop/messages/catalog.hpp"

namespace spikeloop::messages {

inline constexpr std::string_view kRos1 = "ros1";
inline constexpr std::string_view kRos1Definition = "ros1msg";
inline constexpr std::string_view kRos2 = "cdr";
inline constexpr std::string_view kRos2Definition = "ros2msg";

struct Schema {
  std::string encoding;             ///< of messages, as kRos1
  std::string type;                 ///< "sensor_msgs/LaserScan", "sensor_msgs/msg/LaserScan"
  std::string definition_encoding;  ///< as kRos1Definition
  std::string definition;           ///< with all parts
};

/// @throws ConfigurationError as Catalog::for_type().
Schema schema_of(Dialect dialect, std::string_view type);

/// The definition of a schema, without the last fields if the message of an older version lacks
/// them (Humble's Range).
std::string definition_for(const Schema& schema, const TypeLayout& type,
                           std::span<const std::byte> message);

}  // namespace spikeloop::messages
