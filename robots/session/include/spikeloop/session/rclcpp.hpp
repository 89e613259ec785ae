// The border between our programs and the library of the ROS package spikeloop_ros, which takes
// part in ROS 2 by rclcpp: over every middleware that a ROS 2 installation has.
#pragma once

#include <string>

#include "spikeloop/topics/session.hpp"

namespace spikeloop::session {

/// Set to kRclcpp, this variable makes nodes of ROS 2 by rclcpp; not set, or empty: by Cyclone DDS.
/// It is in the `place` of a session by rclcpp.
inline constexpr const char* kTransportVariable = "SPIKELOOP_ROS2";
inline constexpr const char* kRclcpp = "rclcpp";
/// `setup.bash` of the workspace lets the loader find it.
inline constexpr const char* kRclcppLibrary = "libspikeloop_rclcpp.so";
/// Its one function, a RclcppFactory. The number changes with whatever both sides see: this file,
/// topics::Session, topics::SessionSettings.
inline constexpr const char* kRclcppFactory = "spikeloop_rclcpp_session_4";

/// "geometry_msgs/Twist" of what a user wrote ("Twist", the path of a .msg file).
/// @throws ConfigurationError for an unknown type.
using FullType = std::string (*)(const std::string& message_type);

/// @return to be deleted. @throws ConfigurationError, TransportError as topics::Session has them.
using RclcppFactory = topics::Session*(const topics::SessionSettings& settings, FullType full_type);

}  // namespace spikeloop::session
