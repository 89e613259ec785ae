// Subscriber of messages as bytes.
#pragma once

#include <ros/ros.h>

#include <atomic>
#include <map>
#include <memory>
#include <mutex>
#include <string>

#include "raw_message.hpp"
#include "spikeloop/topics/session.hpp"

namespace spikeloop::ros1 {

/// Connection header of a publisher: `type`, `md5sum`, `callerid`...
using PublisherHeader = std::map<std::string, std::string>;

/// Takes the messages of a subscription. Shared with roscpp, because unsubscribing waits for no
/// callback after a shutdown of ROS.
class Receiver {
 public:
  explicit Receiver(topics::Subscription subscription);

  const topics::Subscription& wanted() const { return wanted_; }
  const std::string& type() const { return type_; }
  const std::string& md5() const { return md5_; }
  bool latched() const { return latched_; }

  void take(const ros::MessageEvent<const RawMessage>& event);
  /// Reports a publisher that has another type, or another version of this one.
  /// @return true if it was reported
  bool refuse_other_type(const PublisherHeader& publisher);
  /// Reports that this process subscribes to the topic with another type.
  void refuse_conflict() const;
  /// Waits for a callback that is running; none runs afterwards.
  void close();

 private:
  topics::Subscription wanted_;
  std::string type_;
  std::string md5_;
  std::mutex mutex_;
  bool closed_ = false;
  std::atomic<bool> latched_{false};  ///< True if the publisher of the newest message latches
};

class RawSubscriber : public topics::RawSubscriber {
 public:
  /// As Session::subscriber.
  RawSubscriber(ros::NodeHandle& node, topics::Subscription subscription);
  /// Waits for a callback that is running; none runs afterwards.
  ~RawSubscriber() override;

  bool has_publishers() const override;
  bool latched() const override { return receiver_->latched(); }
  const std::shared_ptr<Receiver>& receiver() const { return receiver_; }

 private:
  std::shared_ptr<Receiver> receiver_;
  ros::Subscriber subscriber_;
};

}  // namespace spikeloop::ros1
