// A command adapter's side of the guard.
#pragma once

#include <atomic>

#include "spikeloop/core/time.hpp"
#include "spikeloop/guard/protocol.hpp"

namespace spikeloop::guard {

/// Tells the guard that SPIKELOOP_GUARD names that we live. Without the variable every call does
/// nothing. A guard that is not there is a warning: the job goes on without.
class Link {
 public:
  /// Waits until the guard could stop the robot, at most 5 s.
  explicit Link(const Hello& hello);
  Link(const Link&) = delete;
  Link& operator=(const Link&) = delete;

  bool guarded() const { return guarded_.load(); }
  /// Whether somebody hears the guard's commands, too, as far as it has said; true without a guard.
  /// Never waits. To be called from one thread.
  bool reaches_robot();
  /// To be called from the thread that stops the robot: its silence is what the guard waits for.
  /// Never waits. Returns when to call again.
  TimeNs beat(TimeNs now);
  /// We cannot stop the robot any more: the guard does it at once. Safe to call from any thread.
  void abandon();
  /// The robot is stopped for good. Safe to call from any thread.
  void done();

 private:
  void introduce(const Hello& hello);
  void go_without(const std::string& reason);

  Descriptor socket_;
  std::atomic<bool> guarded_{false};
  bool reaches_ = false;
};

}  // namespace spikeloop::guard
