// The robots that the guard watches.
#pragma once

#include <atomic>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <thread>

#include "spikeloop/guard/guard_timer.hpp"
#include "spikeloop/guard/protocol.hpp"
#include "spikeloop/topics/rosout.hpp"
#include "spikeloop/topics/session.hpp"

namespace spikeloop::guard {

/// The guard as a node of ROS: one session per version of ROS for all robots.
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

/// One command adapter that the guard watches, in a separate thread: starting ROS may take seconds,
/// in which the other robots must stay guarded.
class GuardedRobot {
 public:
  struct Events {
    std::function<void()> changed;  ///< needed() or ended() may have changed
    /// Called after the robot of an adapter that had died was stopped.
    std::function<void(const Hello&)> stopped;
  };
  /// Events are called from the thread of this robot.
  GuardedRobot(Descriptor socket, Robots& robots, Events events);
  /// Ends the watch; a robot that is being stopped receives its remaining stop commands.
  ~GuardedRobot();
  GuardedRobot(const GuardedRobot&) = delete;
  GuardedRobot& operator=(const GuardedRobot&) = delete;

  /// True while the adapter lives, or its robot is being stopped.
  bool needed() const { return needed_.load(); }
  bool ended() const { return ended_.load(); }

 private:
  void run();
  bool read_introduction();
  /// Returns null if the robot is not to be watched: the guard refuses, or the adapter has gone.
  std::unique_ptr<topics::RawPublisher> advertise();
  void watch(topics::RawPublisher& robot);
  void listen(GuardTimer& timer);
  void stop(topics::RawPublisher& robot);
  void announce(const GuardTimer& timer);
  void refuse(const std::string& reason, bool ends_run = false);
  void set_needed(bool needed);

  Descriptor socket_;
  Descriptor leave_;  ///< eventfd: readable when the guard ends
  Robots& robots_;
  Events events_;
  Hello hello_;
  std::optional<Cause> announced_;
  std::atomic<bool> needed_{false};
  std::atomic<bool> ended_{false};
  std::thread thread_;
};

}  // namespace spikeloop::guard
