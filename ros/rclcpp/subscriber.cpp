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
      reliable_(subscription_.queue == 0 || subscription_.reliable),
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

/// As reliable_ and late_ have it; in place of the subscription before.
void Subscriber::subscribe() {
  rclcpp::QoS qos = reliable_qos(subscription_.queue, late_);
  if (!reliable_ && !late_) {
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
/// effort, and one that requests earlier messages nothing from those that do not keep them.
void Subscriber::look() {
  const std::string topic = subscriber()->get_topic_name();
  bool best_effort = false;
  bool any = false;
  bool latched = true;
  for (const auto& publisher : node_->get_publishers_info_by_topic(topic)) {
    const std::string other = plain_type(publisher.topic_type());
    if (other != type_) {
      refuse(topic, other, publisher);
      continue;
    }
    const bool reliable =
        publisher.qos_profile().reliability() != rclcpp::ReliabilityPolicy::BestEffort;
    any = true;
    best_effort |= !reliable;
    latched &= reliable &&
               publisher.qos_profile().durability() == rclcpp::DurabilityPolicy::TransientLocal;
  }
  latched_ = any ? latched : latched_.load();
  const bool late = any && latched && subscription_.latched;
  if ((reliable_ && best_effort) || late != late_) {
    reliable_ = reliable_ && !best_effort;
    late_ = late;
    subscribe();
  }
}

void Subscriber::refuse(const std::string& topic, const std::string& type,
                        const rclcpp::TopicEndpointInfo& publisher) {
  if (subscription_.refuse && refused_.insert(type).second) {
    subscription_.refuse({.type = type,
                          .text = "topic '" + topic + "' carries " + type + ", not " + type_,
                          .node = [node = node_name_of(publisher)] { return node; }});
  }
}

}  // namespace spikeloop::ros
