// Plays the events of a camera back at their own times, a while after they happened.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "spikeloop/core/signal.hpp"
#include "spikeloop/messages/event_conversion.hpp"

namespace spikeloop::messages {

/// What the simulated clock shows when a sensor's own clock shows a stamp.
/// Both clocks go equally fast; the first message says how far apart they are.
class SensorClock {
 public:
  /// Events that seem to come from so far in the future are a jump of the sensor's clock: nothing
  /// would be heard of it until then.
  static constexpr TimeNs kFarthest = kNsPerSecond;

  /// A message whose newest event has this stamp is there when the simulated clock shows `now`. The
  /// first one is taken to have arrived when that event happened; so is one whose stamp lies before
  /// that of the message before (a recording that begins again), or too far ahead.
  void take(TimeNs newest, TimeNs now);

  TimeNs simulated(TimeNs stamp) const { return stamp + offset_; }
  std::uint64_t jumps() const { return jumps_; }

 private:
  bool set_ = false;
  TimeNs newest_ = 0;
  TimeNs offset_ = 0;
  std::uint64_t jumps_ = 0;
};

/// A camera collects events and sends them together, so a message's oldest event is as old as the
/// message is long. `latency` is that while: what happened at simulated time s is sent at
/// s + latency, in the interval that contains it. What comes later than that is sent right behind
/// the begin of the interval, and counted; nothing is dropped.
class EventPlayback {
 public:
  explicit EventPlayback(TimeNs latency) : latency_(latency) {}

  /// The spikes of this interval, sorted by time; valid until the next call.
  /// @param messages those that have come since the last call, in the order in which they came
  std::span<const Spike> step(std::span<const EventMessage> messages, const Interval& interval);

  std::uint64_t late() const { return late_; }
  TimeNs worst_lateness() const { return worst_lateness_; }
  std::uint64_t clock_jumps() const { return clock_.jumps(); }
  std::size_t waiting() const { return queue_.size() - sent_; }

 private:
  void add(const EventMessage& message, const Interval& interval);
  void sort_behind(std::size_t begin);

  TimeNs latency_;
  SensorClock clock_;
  std::vector<Spike> queue_;  ///< sorted by time
  std::size_t sent_ = 0;      ///< so many at its begin have been sent
  std::uint64_t late_ = 0;
  TimeNs worst_lateness_ = 0;
};

}  // namespace spikeloop::messages
