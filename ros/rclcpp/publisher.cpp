#include "publisher.hpp"

#include <chrono>
#include <cmath>
#include <cstring>
#include <exception>
#include <utility>

namespace spikeloop::ros {

namespace {

/// A subscriber that is stopped never acknowledges; what it missed is with the system by then.
constexpr std::chrono::milliseconds kLongestDrain{100};

/// Middlewares report "infinite" as 0 or as many years.
bool is_finite(const rclcpp::Duration& duration) {
  constexpr double kYear_s = 365.0 * 24 * 3600;
  return duration.seconds() > 0 && duration.seconds() < kYear_s;
}

std::string milliseconds(const rclcpp::Duration& duration) {
  return std::to_string(std::llround(1000 * duration.seconds())) + " ms";
}

}  // namespace

Publisher::Publisher(std::shared_ptr<rclcpp::Node> node, const std::string& topic,
                     const std::string& type, const rclcpp::QoS& qos)
    : node_(std::move(node)),
      type_(type),
      qos_(qos),
      publisher_(node_->create_generic_publisher(topic, type, qos)) {}

void Publisher::publish(std::span<const std::byte> message) {
  message_.reserve(message.size());
  rcl_serialized_message_t& raw = message_.get_rcl_serialized_message();
  std::memcpy(raw.buffer, message.data(), message.size());
  raw.buffer_length = message.size();
  try {
    publisher_->publish(message_);
  } catch (const std::exception& error) {
    RCLCPP_WARN_ONCE(node_->get_logger(), "a message on '%s' was not sent: %s; this is said once",
                     publisher_->get_topic_name(), error.what());
  }
}

bool Publisher::has_subscribers() const {
  return publisher_->get_subscription_count() > 0;
}

// In the words of robots/ros2. rclcpp::qos_check_compatible() reports nodes of plain DDS that are
// compatible.
std::string Publisher::misfit() const {
  for (const auto& subscriber :
       node_->get_subscriptions_info_by_topic(publisher_->get_topic_name())) {
    if (subscriber.topic_type() != type_) {
      continue;
    }
    const rclcpp::QoS& wanted = subscriber.qos_profile();
    if (wanted.durability() == rclcpp::DurabilityPolicy::TransientLocal &&
        qos_.durability() != rclcpp::DurabilityPolicy::TransientLocal) {
      return "durability transient local, but Spikeloop's publisher is volatile";
    }
    if (is_finite(wanted.deadline())) {
      return "a deadline of " + milliseconds(wanted.deadline()) +
             ", but Spikeloop's publisher has none";
    }
    if (wanted.liveliness() == rclcpp::LivelinessPolicy::ManualByTopic) {
      return "liveliness by topic, but that of Spikeloop's publisher is automatic";
    }
    if (is_finite(wanted.liveliness_lease_duration())) {
      return "a liveliness lease of " + milliseconds(wanted.liveliness_lease_duration()) +
             ", but Spikeloop's publisher has none";
    }
  }
  return {};
}

bool Publisher::deliver() const {
  try {
    return publisher_->wait_for_all_acked(kLongestDrain);
  } catch (const rclcpp::exceptions::RCLError&) {
    return true;  // a middleware that knows no acknowledgements has sent what was published
  }
}

}  // namespace spikeloop::ros
