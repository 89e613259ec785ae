#include "publisher.hpp"

#include <chrono>
#include <cstring>
#include <exception>
#include <utility>

namespace spikeloop::ros {

namespace {

/// A subscriber that is stopped never acknowledges; what it missed is with the system by then.
constexpr std::chrono::milliseconds kLongestDrain{100};

}  // namespace

Publisher::Publisher(std::shared_ptr<rclcpp::Node> node, const std::string& topic,
                     const std::string& type, const rclcpp::QoS& qos)
    : node_(std::move(node)),
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

// rclcpp warns of other policies by itself; rclcpp::qos_check_compatible() takes nodes of plain DDS
// for misfits that are none.
std::string Publisher::misfit() const {
  if (qos_.durability() == rclcpp::DurabilityPolicy::TransientLocal) {
    return {};
  }
  for (const auto& subscriber :
       node_->get_subscriptions_info_by_topic(publisher_->get_topic_name())) {
    if (subscriber.qos_profile().durability() == rclcpp::DurabilityPolicy::TransientLocal) {
      return "durability transient local, but Spikeloop's publisher is volatile";
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
