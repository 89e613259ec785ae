#include "raw_subscriber.hpp"

#include <fmt/format.h>

#include <utility>

#include "spikeloop/core/code.hpp"
#include "spikeloop/core/error.hpp"
#include "spikeloop/messages/catalog.hpp"
#include "spikeloop/topics/names.hpp"

namespace spikeloop::ros1 {

Receiver::Receiver(topics::Subscription subscription) : wanted_(std::move(subscription)) {
  const auto& catalog = messages::Catalog::for_type(messages::Dialect::ros1, wanted_.message_type);
  type_ = catalog.full_name(wanted_.message_type);
  md5_ = catalog.md5(type_);
}

void Receiver::take(const ros::MessageEvent<const RawMessage>& event) {
  const std::lock_guard lock(mutex_);
  if (!closed_) {
    const ros::M_string& header = event.getConnectionHeader();
    const auto latching = header.find("latching");
    latched_ = latching != header.end() && latching->second == "1";
    wanted_.take(event.getConstMessage()->bytes);
  }
}

void Receiver::close() {
  const std::lock_guard lock(mutex_);
  closed_ = true;
}

bool Receiver::refuse_other_type(const PublisherHeader& publisher) {
  const auto entry = [&](const char* key) {
    const auto found = publisher.find(key);
    return found == publisher.end() ? std::string() : found->second;
  };
  const std::string type = entry("type");
  const std::string md5 = entry("md5sum");
  const bool is_other_version = !md5.empty() && md5 != md5_ && md5 != "*";
  if (type.empty() || (type == type_ && !is_other_version)) {
    return false;
  }
  topics::OtherType other =
      topics::other_type(wanted_.topic, type, type_, [node = entry("callerid")] { return node; });
  if (type == type_) {
    other.type.clear();
    other.text = fmt::format(
        "topic '{}' carries another version of {} (md5 sum {}, Spikeloop's is {}); its publisher "
        "must use the version of ROS Noetic",
        wanted_.topic, type_, md5, md5_);
  }
  const std::lock_guard lock(mutex_);
  if (!closed_ && wanted_.refuse) {
    wanted_.refuse(other);
  }
  return true;
}

void Receiver::refuse_conflict() const {
  if (wanted_.refuse) {
    wanted_.refuse({.type = "",
                    .text = fmt::format("topic '{}' is subscribed as {} and as another type by one "
                                        "process, and a topic of ROS 1 has one type",
                                        wanted_.topic, type_)});
  }
}

RawSubscriber::RawSubscriber(ros::NodeHandle& node, topics::Subscription subscription) {
  topics::check_topic(messages::Dialect::ros1, subscription.topic);
  receiver_ = std::make_shared<Receiver>(std::move(subscription));
  const topics::Subscription& wanted = receiver_->wanted();
  ros::SubscribeOptions options;
  options.initByFullCallbackType<const ros::MessageEvent<const RawMessage>&>(
      wanted.topic, wanted.queue,
      [receiver = receiver_](const ros::MessageEvent<const RawMessage>& event) {
        receiver->take(event);
      });
  // Not "*": roscpp would then take the type of its first publisher, and refuse all others.
  options.datatype = receiver_->type();
  options.md5sum = receiver_->md5();
  options.transport_hints = ros::TransportHints().tcpNoDelay();
  try {
    subscriber_ = node.subscribe(options);
  } catch (const ros::ConflictingSubscriptionException&) {
    receiver_->refuse_conflict();
    return;
  }
  if (!subscriber_ && ros::ok()) {
    throw TransportError(
        with_code(Code::no_ros_master,
                  "what answers at {} refuses a subscriber of topic '{}': it is no ROS master; set "
                  "ROS_MASTER_URI to where roscore is",
                  ros::master::getURI(), wanted.topic));
  }
}

RawSubscriber::~RawSubscriber() {
  subscriber_.shutdown();
  receiver_->close();
}

bool RawSubscriber::has_publishers() const {
  return subscriber_.getNumPublishers() != 0;
}

}  // namespace spikeloop::ros1
