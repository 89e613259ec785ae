// The guard as a ROS 1 node: one session for all robots that it watches over.
#pragma once

#include <memory>
#include <mutex>
#include <string>

#include "spikeloop/guard/protocol.hpp"
#include "spikeloop/ros1/raw_publisher.hpp"
#include "spikeloop/ros1/session.hpp"

namespace spikeloop::guard {

class Robots {
 public:
  /// Begins to publish on the adapter's topic, so that subscribers are connected when a zero must
  /// leave. The first one decides about the ROS master. Safe to call from any thread; may wait some
  /// seconds for the master.
  /// @throws Error when the guard could not stop this robot.
  std::unique_ptr<ros1::RawPublisher> advertise(const Hello& hello);

 private:
  std::mutex mutex_;
  std::string master_uri_;
  std::unique_ptr<ros1::Session> session_;
};

}  // namespace spikeloop::guard
