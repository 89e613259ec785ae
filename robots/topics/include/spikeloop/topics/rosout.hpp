// What a node of ROS logs, on /rosout.
#pragma once

#include <exception>
#include <memory>
#include <string>

#include "spikeloop/topics/session.hpp"

namespace spikeloop::topics {

/// Publishes what this process logs: as rcl_interfaces/Log, as nodes of rclcpp do, reliable,
/// transient local, the newest 1000; over ROS 1 as rosgraph_msgs/Log, latched, so that a subscriber
/// that comes later gets the newest. At most 50 messages a second; how many were left out is the
/// next one. Does nothing in a session inside the process.
class Rosout {
 public:
  explicit Rosout(Session& session);
  /// Publishes what is left, and waits for the subscribers as RawPublisher::drain.
  ~Rosout();
  Rosout(const Rosout&) = delete;
  Rosout& operator=(const Rosout&) = delete;

  /// What ends the run. It is not logged.
  void error(const std::string& text);
  /// Does the work; an error that it throws is published, too.
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
