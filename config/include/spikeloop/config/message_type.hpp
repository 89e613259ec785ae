// Names of message types.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace spikeloop {

/// "sensor_msgs/LaserScan" from any spelling of the ROS 1 and ROS 2 name or of the older programs:
/// Laserscan, LaserScan, sensor_msgs/LaserScan, sensor_msgs/msg/LaserScan; Twist; FloatArray,
/// Float64MultiArray; Odom, Odometry.
/// @throws ConfigurationError with a suggestion.
std::string canonical_message_type(std::string_view text);

/// The names that `canonical_message_type` returns.
std::vector<std::string> known_message_types();

}  // namespace spikeloop
