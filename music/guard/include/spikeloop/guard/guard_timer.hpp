// Decides when a guard stops the robot. A pure function of messages and times.
#pragma once

#include <optional>

#include "spikeloop/core/time.hpp"

namespace spikeloop::guard {

/// Wall time between two beats of a command adapter to its guard.
inline constexpr TimeNs kBeatPeriod = 20'000'000;
/// Tolerated delay of a beat on a busy machine.
inline constexpr TimeNs kMargin = 100'000'000;

/// Longest wall time between two beats of an adapter with this watchdog, or of its launcher. After
/// a longer silence the robot is stopped.
TimeNs deadline_for(TimeNs watchdog);

/// Wall time between two beats of a guard to an adapter, and to the launcher.
inline constexpr TimeNs kGuardBeatPeriod = 100'000'000;
/// Wall time without a beat of the guard after which it counts as lost.
inline constexpr TimeNs kGuardSilence = 500'000'000;

/// Number of stop commands of a guard, so that the robot's last message is a stop command. Then it
/// sends nothing, because another program may drive the robot.
inline constexpr int kZeros = 5;
inline constexpr TimeNs kZeroInterval = 50'000'000;
/// Stop commands without a subscriber do not count, but none is sent after this time. Over Fast DDS
/// a guard and a robot may need two seconds to discover each other.
inline constexpr TimeNs kLongestStop = 3 * kNsPerSecond;

enum class Cause {
  lost,   ///< the connection has ended before "done"
  silent  ///< no beat for too long
};

/// The watch over one command adapter. All times are wall time.
class GuardTimer {
 public:
  /// @param watchdog watchdog of the adapter
  GuardTimer(TimeNs watchdog, TimeNs now);

  void beat(TimeNs now);
  /// Ends the watch: the adapter has stopped the robot itself.
  void done();
  /// Begins the stop: the connection has ended.
  void lost(TimeNs now);

  /// Returns true if a stop command is to be sent now.
  /// @param has_subscriber True if the commands have a subscriber
  bool poll(TimeNs now, bool has_subscriber);
  /// Earliest time at which poll() may return true if nothing arrives.
  TimeNs next_due() const;

  /// True if further stop commands will be sent.
  bool stopping() const { return state_ == State::stopping; }
  bool over() const { return state_ == State::over; }
  /// Cause of the stop; nullopt while the adapter drives the robot, or if it has stopped it itself.
  std::optional<Cause> cause() const { return cause_; }
  /// True if a stop command had a subscriber.
  bool robot_stopped() const { return robot_stopped_; }
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
