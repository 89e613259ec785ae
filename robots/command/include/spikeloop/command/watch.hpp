// A thread beside the loop that stops the robot when the loop cannot: it watches the ticks and the
// signals that tell of other programs' deaths, and sends what is due between ticks.
#pragma once

#include <functional>
#include <memory>

#include "spikeloop/command/command_channel.hpp"
#include "spikeloop/core/time.hpp"

namespace spikeloop::command {

class Watch {
 public:
  struct Actions {
    std::function<void(StopReason)> stop;    ///< with `silent` or `continued`: zero command, now
    std::function<TimeNs(TimeNs now)> poll;  ///< sends what is due; returns when to call again
    std::function<void()> interrupted{};     ///< SIGINT has come
    /// Tells somebody outside that the watch lives; returns when to call again. May be left out.
    std::function<TimeNs(TimeNs now)> beat{};
  };

  /// Blocks SIGCONT and SIGINT in the calling thread, and so in every thread it starts afterwards.
  /// Call it first in main(), before any library has threads: a signal that some thread does not
  /// block never reaches the watch.
  static void block_signals();
  /// Undoes it for the calling thread: a process that turns out to have nothing to stop.
  static void release_signals();

  /// @param timeout wall time without a heartbeat after which the loop counts as silent
  Watch(TimeNs timeout, Actions actions);
  ~Watch();
  Watch(const Watch&) = delete;
  Watch& operator=(const Watch&) = delete;

  /// The loop lives; from the first one on, its silence stops the robot.
  /// @param next_due when `poll` should be called if no heartbeat comes before
  void heartbeat(TimeNs next_due = kNever);
  /// The loop is over: its silence means nothing any more.
  void rest();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace spikeloop::command
