// When a guard stops the robot. A pure function of messages and times, so that every rule is a
// test.
#pragma once

#include <optional>

#include "spikeloop/core/time.hpp"

namespace spikeloop::guard {

/// A command adapter says so often that it lives.
inline constexpr TimeNs kBeatPeriod = 20'000'000;
/// Its watchdog and that much without a beat: then it cannot stop the robot itself. The thread that
/// beats may be that late on a busy machine.
inline constexpr TimeNs kMargin = 100'000'000;

/// Longest wall time between two beats of an adapter with this watchdog, or of its launcher. Then
/// the robot is stopped.
TimeNs deadline_for(TimeNs watchdog);

/// Wall time between two beats of a guard to an adapter, and to the launcher.
inline constexpr TimeNs kGuardBeatPeriod = 100'000'000;
/// Wall time without a beat of the guard after which it counts as lost.
inline constexpr TimeNs kGuardSilence = 500'000'000;

/// A robot that is stopped gets this many zero commands, so that one is the last whatever was still
/// on its way; then no more: somebody else may want to drive.
inline constexpr int kZeros = 5;
inline constexpr TimeNs kZeroInterval = 50'000'000;
/// Zeros without a subscriber do not count; no more zeros are sent after this time. Over Fast DDS a
/// guard and a robot may need two seconds to discover each other.
inline constexpr TimeNs kLongestStop = 3 * kNsPerSecond;

enum class Cause {
  lost,   ///< the connection has ended, and the adapter has not said that it stopped the robot
  silent  ///< no beat for too long
};

/// The watch over one command adapter. All times are wall time.
class GuardTimer {
 public:
  /// @param watchdog the adapter's own: how long it leaves the robot without a new command
  GuardTimer(TimeNs watchdog, TimeNs now);

  void beat(TimeNs now);
  /// The adapter has stopped the robot for good.
  void done();
  /// The connection has ended.
  void lost(TimeNs now);

  /// True: a zero command leaves now.
  /// @param heard whether anybody subscribes to the commands
  bool poll(TimeNs now, bool heard);
  /// When poll() may say true if nothing comes.
  TimeNs next_due() const;

  /// Zeros are still to be sent.
  bool stopping() const { return state_ == State::stopping; }
  /// Nothing more can come of it.
  bool over() const { return state_ == State::over; }
  /// Why the robot was stopped; nothing while the adapter drives it, or has stopped it itself.
  std::optional<Cause> cause() const { return cause_; }
  /// True if a zero command of this stop had a subscriber.
  bool robot_stopped() const { return robot_stopped_; }
  /// Longest time without a beat.
  TimeNs deadline() const { return deadline_; }

 private:
  void begin(Cause cause, TimeNs now);

  enum class State { watching, stopping, silent, over };
  TimeNs deadline_;
  TimeNs last_beat_;
  State state_ = State::watching;
  std::optional<Cause> cause_;
  TimeNs stopping_since_ = 0;
  TimeNs next_zero_ = 0;
  int zeros_left_ = 0;
  bool robot_stopped_ = false;
};

}  // namespace spikeloop::guard
