// Topics on which an experiment does not depend.
#pragma once

#include <memory>
#include <utility>

#include "spikeloop/core/error.hpp"
#include "spikeloop/topics/session.hpp"

namespace spikeloop {

/// @return nullptr if ROS does not have the message type: by rclcpp the type's package may not be
/// installed.
inline std::unique_ptr<topics::RawSubscriber> optional_subscriber(
    topics::Session& session, topics::Subscription subscription) {
  try {
    return session.subscriber(std::move(subscription));
  } catch (const ConfigurationError&) {
    return nullptr;
  }
}

}  // namespace spikeloop
