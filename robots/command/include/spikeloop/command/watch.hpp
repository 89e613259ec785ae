// A thread that stops the robot when the loop cannot: it watches ticks and signals, and sends what
// is due between ticks.
#pragma once

#include <functional>
#include <memory>

#include "spikeloop/command/command_channel.hpp"
#include "spikeloop/core/time.hpp"

namespace spikeloop::command {

class Watch {
 public:
  struct Actions {
    std::function<void(StopReason)> stop;    ///< with `silent` or `continued`: stop command, now
    std::function<TimeNs(TimeNs now)> poll;  ///< sends what is due; returns when to call again
    std::function<void()> interrupted{};     ///< SIGINT has come
    /// Sends a beat to other processes; returns when to call again. May be empty.
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

  /// The loop is running; from the first heartbeat on, its silence stops the robot.
  /// @param next_due when `poll` should be called if no heartbeat comes before
  void heartbeat(TimeNs next_due = kNever);
  /// The loop has ended: its silence no longer counts.
  void rest();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace spikeloop::command
