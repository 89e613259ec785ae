#include "subscriber.hpp"

#include <chrono>
#include <cstddef>
#include <span>
#include <utility>

#include "conventions.hpp"

namespace spikeloop::ros {

namespace {

/// rclcpp says nothing of publishers of another type; the graph is looked at as often as this.
constexpr std::chrono::milliseconds kLook{500};

rclcpp::QoS qos_of(const topics::Subscription& subscription) {
  rclcpp::QoS qos = reliable_qos(subscription.queue, subscription.latched);
  return subscription.queue == 0 || subscription.latched ? qos : qos.best_effort();
}

}  // namespace

Subscriber::Subscriber(std::shared_ptr<rclcpp::Node> node, topics::Subscription subscription,
                       const std::string& type)
    : node_(std::move(node)),
      subscription_(std::move(subscription)),
      type_(type),
      take_(std::make_shared<Take>([take = subscription_.take](const auto& message) {
        const rcl_serialized_message_t& raw = message.get_rcl_serialized_message();
        take(std::as_bytes(std::span(raw.buffer, raw.buffer_length)));
      })),
      look_(std::make_shared<topics::Closable<>>([this] { look_for_other_types(); })) {
  const auto hand_on = [take = take_](std::shared_ptr<const rclcpp::SerializedMessage> message) {
    take->call(*message);
  };
  subscriber_ = node_->create_generic_subscription(subscription_.topic, ros2_type(type_),
                                                   qos_of(subscription_), hand_on);
  if (subscription_.refuse) {
    looking_ = node_->create_wall_timer(kLook, [look = look_] { look->call(); });
  }
}

Subscriber::~Subscriber() {
  take_->close();
  look_->close();
}

bool Subscriber::has_publishers() const {
  return subscriber_->get_publisher_count() > 0;
}

void Subscriber::look_for_other_types() {
  const std::string topic = subscriber_->get_topic_name();
  for (const auto& publisher : node_->get_publishers_info_by_topic(topic)) {
    if (const std::string other = plain_type(publisher.topic_type()); other != type_) {
      subscription_.refuse(
          {.type = other, .text = "topic '" + topic + "' carries " + other + ", not " + type_});
    }
  }
}

}  // namespace spikeloop::ros
