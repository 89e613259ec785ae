// A thread that watches ticks and signals, stops the robot when the loop cannot, and sends messages
// that are due between ticks.
#pragma once

#include <functional>
#include <memory>

#include "spikeloop/command/command_channel.hpp"
#include "spikeloop/core/time.hpp"

namespace spikeloop::command {

class Watch {
 public:
  struct Actions {
    std::function<void(StopReason)> stop;  ///< sends the stop command; `silent` or `continued`
    /// Sends due messages. Returns the time of the next call.
    std::function<TimeNs(TimeNs now)> poll;
    std::function<void()> interrupted{};  ///< called after SIGINT
    /// Sends a beat to other processes. Returns the time of the next call. May be empty.
    std::function<TimeNs(TimeNs now)> beat{};
  };

  /// Blocks SIGCONT and SIGINT in the calling thread, and so in every thread it starts afterwards.
  /// Call it first in main(), before any library has threads: a signal that some thread does not
  /// block never reaches the watch.
  static void block_signals();
  /// Reverts block_signals() in the calling thread, for a process that has no robot to stop.
  static void release_signals();

  /// @param timeout wall time without a heartbeat after which the loop counts as silent
  Watch(TimeNs timeout, Actions actions);
  ~Watch();
  Watch(const Watch&) = delete;
  Watch& operator=(const Watch&) = delete;

  /// Called by the running loop. From the first heartbeat on, a missing heartbeat stops the robot.
  /// @param next_due time at which to call `poll` if there is no heartbeat before
  void heartbeat(TimeNs next_due = kNever);
  /// Called when the loop has ended. Missing heartbeats no longer stop the robot.
  void rest();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace spikeloop::command
