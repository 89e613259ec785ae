// This process as a node of ROS, of the version that is asked for.
#pragma once

#include <atomic>
#include <memory>

#include "spikeloop/core/time.hpp"
#include "spikeloop/topics/session.hpp"

namespace spikeloop::session {

struct Settings : topics::SessionSettings {
  messages::Dialect ros = messages::Dialect::ros1;
  TimeNs master_timeout = 5 * kNsPerSecond;  ///< how long to wait for ROS 1's master
  /// Ends that wait when it becomes true; null: nobody does.
  const std::atomic<bool>* cancelled = nullptr;
};

/// Block the signals you wait for before: a session starts threads.
/// @return null when `cancelled` became true before ROS 1's master answered
/// @throws TransportError without a master, ConfigurationError for an impossible name or place.
std::unique_ptr<topics::Session> open(const Settings& settings);

}  // namespace spikeloop::session
