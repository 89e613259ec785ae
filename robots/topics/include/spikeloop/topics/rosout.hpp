// Publishes the log of a node on /rosout.
#pragma once

#include <exception>
#include <memory>
#include <string>

#include "spikeloop/topics/session.hpp"

namespace spikeloop::topics {

/// Publishes the log of this process. ROS 2: as rcl_interfaces/Log, as nodes of rclcpp do,
/// reliable, transient local, the newest 1000. ROS 1: as rosgraph_msgs/Log, latched, so that later
/// subscribers receive the newest message. At most 50 messages per second; the next message reports
/// the number of those left out. Does nothing in a session inside the process.
class Rosout {
 public:
  explicit Rosout(Session& session);
  /// Publishes the remaining messages, and waits for the subscribers as RawPublisher::drain.
  ~Rosout();
  Rosout(const Rosout&) = delete;
  Rosout& operator=(const Rosout&) = delete;

  /// Publishes the error that ends the run. The error is not logged.
  void error(const std::string& text);
  /// Calls `work`, and publishes an error that it throws.
  template <typename Work>
  auto during(Work&& work) {
    try {
      return work();
    } catch (const std::exception& thrown) {
      error(thrown.what());
      throw;
    }
  }

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace spikeloop::topics
