// Names of message types.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace spikeloop {

/// "sensor_msgs/LaserScan" from any spelling of the ROS 1 and ROS 2 name or of the older programs:
/// Laserscan, LaserScan, sensor_msgs/LaserScan, sensor_msgs/msg/LaserScan; Twist; FloatArray,
/// Float64MultiArray; Odom, Odometry. Any other type has its package in its name, or is the path of
/// a `.msg` file, which becomes its whole path; who has the definitions knows whether they are
/// good.
/// @param base the directory of the file that names a `.msg` file; see find_data_file
/// @throws ConfigurationError with a suggestion, or where it looked for the file.
std::string canonical_message_type(std::string_view text, const std::filesystem::path& base = {});

/// Whether a type is the path of a file with its definition.
bool is_definition_file(std::string_view type);

}  // namespace spikeloop
