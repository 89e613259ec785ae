#include "raw_subscriber.hpp"

#include <fmt/format.h>

#include <atomic>
#include <mutex>
#include <string>
#include <utility>

#include "raw_message.hpp"
#include "spikeloop/core/code.hpp"
#include "spikeloop/core/error.hpp"
#include "spikeloop/messages/catalog.hpp"
#include "spikeloop/topics/names.hpp"

namespace spikeloop::ros1 {

/// roscpp shares it: after a shutdown of ROS, unsubscribing waits for no callback.
class RawSubscriber::Receiver {
 public:
  explicit Receiver(topics::Subscription subscription) : wanted_(std::move(subscription)) {
    const auto& catalog =
        messages::Catalog::for_type(messages::Dialect::ros1, wanted_.message_type);
    type_ = catalog.full_name(wanted_.message_type);
    md5_ = catalog.md5(type_);
  }

  const topics::Subscription& wanted() const { return wanted_; }
  const std::string& type() const { return type_; }
  const std::string& md5() const { return md5_; }

  void take(const ros::MessageEvent<const RawMessage>& event) {
    const std::lock_guard lock(mutex_);
    if (closed_) {
      return;
    }
    if (wanted_.refuse && entry(event, "md5sum") != md5_) {
      refuse(event);
    } else {
      latched_ = entry(event, "latching") == "1";
      wanted_.take(event.getConstMessage()->bytes);
    }
  }
  bool latched() const { return latched_; }
  void close() {
    const std::lock_guard lock(mutex_);
    closed_ = true;
  }

 private:
  /// What the publisher said when it was connected.
  static std::string entry(const ros::MessageEvent<const RawMessage>& event, const char* key) {
    const auto found = event.getConnectionHeader().find(key);
    return found == event.getConnectionHeader().end() ? "" : found->second;
  }

  void refuse(const ros::MessageEvent<const RawMessage>& event) const {
    const std::string type = entry(event, "type");
    if (type == type_) {
      wanted_.refuse({.type = "",
                      .text = fmt::format(
                          "topic '{}' carries another version of {} (md5 sum {}, ours is {}); its "
                          "publisher must use the version of ROS Noetic",
                          wanted_.topic, type_, entry(event, "md5sum"), md5_),
                      .node = [node = entry(event, "callerid")] { return node; }});
    } else {
      wanted_.refuse(topics::other_type(wanted_.topic, type, type_,
                                        [node = entry(event, "callerid")] { return node; }));
    }
  }

  topics::Subscription wanted_;
  std::string type_;
  std::string md5_;
  std::mutex mutex_;
  bool closed_ = false;
  std::atomic<bool> latched_{false};  ///< True if the publisher of the newest message latches
};

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
  // Who does not refuse wants nothing of other types; who does must get to know them.
  options.datatype = wanted.refuse ? "*" : receiver_->type();
  options.md5sum = wanted.refuse ? "*" : receiver_->md5();
  options.transport_hints = ros::TransportHints().tcpNoDelay();
  subscriber_ = node.subscribe(options);
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

bool RawSubscriber::latched() const {
  return receiver_->latched();
}

bool RawSubscriber::has_publishers() const {
  return subscriber_.getNumPublishers() != 0;
}

}  // namespace spikeloop::ros1
