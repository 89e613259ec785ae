// The guard as a node of ROS: one session per version of ROS for all robots.
#pragma once

#include <map>
#include <memory>
#include <mutex>

#include "spikeloop/guard/protocol.hpp"
#include "spikeloop/topics/rosout.hpp"
#include "spikeloop/topics/session.hpp"

namespace spikeloop::guard {

class Robots {
 public:
  /// Advertises the topic of the adapter, so that subscribers are connected before a stop. The
  /// first adapter of a ROS version decides on the master or domain. Thread-safe; may wait some
  /// seconds for the master. @throws Error if the guard could not stop this robot.
  std::unique_ptr<topics::RawPublisher> advertise(const Hello& hello);

 private:
  struct Entered {
    topics::Place place;
    std::unique_ptr<topics::Session> session;
    std::unique_ptr<topics::Rosout> rosout;
  };

  std::mutex mutex_;
  std::map<int, Entered> entered_;  ///< by the version of ROS
};

}  // namespace spikeloop::guard
