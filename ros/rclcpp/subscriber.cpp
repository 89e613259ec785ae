#include "subscriber.hpp"

#include <chrono>
#include <span>
#include <utility>

#include "conventions.hpp"

namespace spikeloop::ros {

namespace {

/// rclcpp says nothing of publishers that do not fit; the graph is looked at as often as this.
constexpr std::chrono::milliseconds kLook{100};

}  // namespace

Subscriber::Subscriber(std::shared_ptr<rclcpp::Node> node, topics::Subscription subscription,
                       const std::string& type)
    : node_(std::move(node)),
      subscription_(std::move(subscription)),
      type_(type),
      reliable_(subscription_.queue == 0 || subscription_.reliable || subscription_.latched),
      take_(std::make_shared<Take>([take = subscription_.take](const auto& message) {
        const rcl_serialized_message_t& raw = message.get_rcl_serialized_message();
        take(std::as_bytes(std::span(raw.buffer, raw.buffer_length)));
      })),
      look_(std::make_shared<topics::Closable<>>([this] { look(); })) {
  subscribe();
  looking_ = node_->create_wall_timer(kLook, [look = look_] { look->call(); });
}

Subscriber::~Subscriber() {
  take_->close();
  look_->close();
}

/// Reliably or by best effort, as reliable_ has it; in place of the subscription before.
void Subscriber::subscribe() {
  rclcpp::QoS qos = reliable_qos(subscription_.queue, subscription_.latched);
  if (!reliable_) {
    qos.best_effort();
  }
  auto subscriber = node_->create_generic_subscription(
      subscription_.topic, ros2_type(type_), qos,
      [take = take_](std::shared_ptr<const rclcpp::SerializedMessage> message) {
        take->call(*message);
      });
  const std::lock_guard lock(mutex_);
  subscriber_ = std::move(subscriber);
}

std::shared_ptr<rclcpp::GenericSubscription> Subscriber::subscriber() const {
  const std::lock_guard lock(mutex_);
  return subscriber_;
}

bool Subscriber::has_publishers() const {
  return subscriber()->get_publisher_count() > 0;
}

/// In the session's thread. A reliable subscriber gets nothing from publishers that are best
/// effort.
void Subscriber::look() {
  const std::string topic = subscriber()->get_topic_name();
  bool best_effort = false;
  for (const auto& publisher : node_->get_publishers_info_by_topic(topic)) {
    best_effort |= publisher.qos_profile().reliability() == rclcpp::ReliabilityPolicy::BestEffort;
    const std::string other = plain_type(publisher.topic_type());
    if (subscription_.refuse && other != type_ && refused_.insert(other).second) {
      subscription_.refuse(
          {.type = other, .text = "topic '" + topic + "' carries " + other + ", not " + type_});
    }
  }
  if (reliable_ && best_effort) {
    reliable_ = false;
    subscribe();
  }
}

}  // namespace spikeloop::ros
