// Names in ROS 2: what a node calls a topic, what it has been remapped to, and what DDS sees.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "spikeloop/topics/arguments.hpp"

namespace spikeloop::ros2 {

struct NodeIdentity {
  std::string name;         ///< "robot"
  std::string space = "/";  ///< its namespace: "/", "/arena", "/arena/left"

  /// "/arena/robot"
  std::string whole() const;
};

/// Name and namespace after `__name` and `__ns`.
/// @throws ConfigurationError for an impossible name.
NodeIdentity node_identity(const std::string& name, const topics::RosArguments& arguments);

/// A node's topics: "scan" is within its namespace, "~/scan" below its name.
class TopicNames {
 public:
  /// Arguments whose names begin with "__" are not for topics; NODE:NAME is for that node alone.
  /// @throws ConfigurationError for an impossible topic in the arguments.
  TopicNames(const NodeIdentity& node, const topics::RosArguments& arguments);

  /// "/arena/scan" of "scan", with what has been remapped. @throws ConfigurationError when
  /// ROS 2 would refuse the name.
  std::string whole(const std::string& topic) const;

 private:
  std::string expanded(const std::string& topic) const;

  NodeIdentity node_;
  std::vector<std::pair<std::string, std::string>> remapped_;  ///< whole names
};

/// "rt/arena/scan": a topic's name in DDS. @throws ConfigurationError when it is too long for
/// ROS 2.
std::string dds_topic(const std::string& whole_topic);
/// "sensor_msgs::msg::dds_::LaserScan_" of "sensor_msgs/LaserScan".
std::string dds_type(const std::string& message_type);
/// The way back; any other name as it is.
std::string ros_type(const std::string& dds_type);

}  // namespace spikeloop::ros2
