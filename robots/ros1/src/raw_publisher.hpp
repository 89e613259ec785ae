// A topic out: the only way in which this module sends.
#pragma once

#include <ros/ros.h>

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "raw_message.hpp"
#include "spikeloop/topics/session.hpp"

namespace spikeloop::ros1 {

class RawPublisher : public topics::RawPublisher {
 public:
  /// As Session::publisher.
  RawPublisher(ros::NodeHandle& node, const std::string& topic, const std::string& message_type,
               std::uint32_t queue, bool latched);

  void publish(std::span<const std::byte> message) override;
  bool has_subscribers() const override;
  /// Leaves roscpp's network thread time to hand what was published to the system.
  void drain() const override;

 private:
  RawMessage message_;
  ros::Publisher publisher_;
};

}  // namespace spikeloop::ros1
