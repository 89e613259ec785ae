// The guard as a node of ROS: one session of each version for all robots that it watches over.
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
  /// Begins to publish on the adapter's topic, so that subscribers are connected when a zero must
  /// leave. The first one of a version decides where its robots are met: the ROS master. Safe to
  /// call from any thread; may wait some seconds for the master.
  /// @throws Error when the guard could not stop this robot.
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
