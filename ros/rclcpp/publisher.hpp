// A topic out, by rclcpp.
#pragma once

#include <cstddef>
#include <memory>
#include <rclcpp/rclcpp.hpp>
#include <rclcpp/serialized_message.hpp>
#include <span>
#include <string>

#include "spikeloop/topics/session.hpp"

namespace spikeloop::ros {

class Publisher final : public topics::RawPublisher {
 public:
  /// @param type "geometry_msgs/msg/Twist". @throws what rclcpp throws
  Publisher(std::shared_ptr<rclcpp::Node> node, const std::string& topic, const std::string& type,
            const rclcpp::QoS& qos);

  void publish(std::span<const std::byte> message) override;
  bool has_subscribers() const override;
  std::string misfit() const override;
  void drain() const override { deliver(); }
  bool deliver() const override;

 private:
  std::shared_ptr<rclcpp::Node> node_;
  std::string type_;  ///< "geometry_msgs/msg/Twist"
  rclcpp::QoS qos_;
  std::shared_ptr<rclcpp::GenericPublisher> publisher_;
  rclcpp::SerializedMessage message_;  ///< kept from message to message
};

}  // namespace spikeloop::ros
