// A topic in.
#pragma once

#include <ros/ros.h>

#include <memory>

#include "spikeloop/topics/session.hpp"

namespace spikeloop::ros1 {

class RawSubscriber : public topics::RawSubscriber {
 public:
  /// As Session::subscriber.
  RawSubscriber(ros::NodeHandle& node, topics::Subscription subscription);
  /// Waits for a callback that is running; none runs afterwards.
  ~RawSubscriber() override;

  bool has_publishers() const override;
  bool latched() const override;

 private:
  class Receiver;
  std::shared_ptr<Receiver> receiver_;
  ros::Subscriber subscriber_;
};

}  // namespace spikeloop::ros1
