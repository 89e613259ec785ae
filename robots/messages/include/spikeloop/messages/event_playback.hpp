// Plays the events of a camera at their own times plus a latency.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "spikeloop/core/signal.hpp"
#include "spikeloop/messages/event_conversion.hpp"

namespace spikeloop::messages {

/// Maps stamps of the sensor's clock to simulated time with a constant offset.
class SensorClock {
 public:
  /// A stamp further ahead is a jump of the sensor's clock; otherwise no event would be sent until
  /// then.
  static constexpr TimeNs kFarthest = kNsPerSecond;

  /// Takes a message that arrives at `now`. The first message, or one after a jump, sets the offset
  /// so that its newest event happens at `now`.
  void take(TimeNs newest, TimeNs now);

  TimeNs simulated(TimeNs stamp) const { return stamp + offset_; }
  std::uint64_t jumps() const { return jumps_; }

 private:
  bool set_ = false;
  TimeNs newest_ = 0;
  TimeNs offset_ = 0;
  std::uint64_t jumps_ = 0;
};

/// Sends an event of simulated time s at s + `latency`, in the interval that contains this time. A
/// camera collects events and sends them together, so that the oldest event of a message is as old
/// as the message is long; `latency` should be this time. An event that arrives later is sent at
/// the begin of the interval, and counted; no event is dropped.
class EventPlayback {
 public:
  explicit EventPlayback(TimeNs latency) : latency_(latency) {}

  /// Spikes of this interval, sorted by time. Valid until the next call.
  /// @param messages messages since the last call, in the order of their arrival
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
  std::size_t sent_ = 0;      ///< number of spikes at its begin that have been sent
  std::uint64_t late_ = 0;
  TimeNs worst_lateness_ = 0;
};

}  // namespace spikeloop::messages
