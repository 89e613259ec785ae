// What rclcpp calls what the session has by other names.
#pragma once

#include <cstddef>
#include <cstdint>
#include <rclcpp/node_interfaces/node_graph_interface.hpp>
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

/// "/left/base": the node of an endpoint.
inline std::string node_name_of(const rclcpp::TopicEndpointInfo& endpoint) {
  const std::string& space = endpoint.node_namespace();
  return (space == "/" ? space : space + "/") + endpoint.node_name();
}

/// "Any number" of messages: a publisher that keeps all of them fails, or waits, when a subscriber
/// is stopped.
inline constexpr std::size_t kMany = 1000;

/// @param queue 0: any number of messages
inline rclcpp::QoS reliable_qos(std::uint32_t queue, bool latched) {
  rclcpp::QoS qos(rclcpp::KeepLast(queue == 0 ? kMany : queue));
  return latched ? qos.transient_local() : qos;
}

}  // namespace spikeloop::ros
