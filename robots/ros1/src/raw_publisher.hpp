// Publisher of messages as bytes, the only sender of this module.
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
  /// Waits until roscpp's network thread has passed the published messages to the kernel.
  void drain() const override;

 private:
  RawMessage message_;
  ros::Publisher publisher_;
};

}  // namespace spikeloop::ros1
