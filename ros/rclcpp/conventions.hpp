// What rclcpp calls what the session has by other names.
#pragma once

#include <cstdint>
#include <rclcpp/qos.hpp>
#include <string>

namespace spikeloop::ros {

/// "sensor_msgs/msg/LaserScan" of "sensor_msgs/LaserScan".
inline std::string ros2_type(const std::string& type) {
  const auto slash = type.find('/');
  return type.substr(0, slash) + "/msg" + type.substr(slash);
}

/// The way back.
inline std::string plain_type(const std::string& ros2_type) {
  return ros2_type.substr(0, ros2_type.find('/')) + ros2_type.substr(ros2_type.rfind('/'));
}

/// @param queue 0: any number of messages
inline rclcpp::QoS reliable_qos(std::uint32_t queue, bool latched) {
  rclcpp::QoS qos =
      queue == 0 ? rclcpp::QoS(rclcpp::KeepAll()) : rclcpp::QoS(rclcpp::KeepLast(queue));
  return latched ? qos.transient_local() : qos;
}

}  // namespace spikeloop::ros
