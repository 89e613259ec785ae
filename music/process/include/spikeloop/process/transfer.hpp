// What happens to spikes and signals at the border to MUSIC, free of MUSIC itself.
#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "spikeloop/core/signal.hpp"
#include "spikeloop/core/time.hpp"

namespace spikeloop::music {

/// The time stamp that MUSIC carries: the double nearest to the time, so that k ticks of 1 ms are
/// the same double as a foreign program's 0.001 * k rounded once.
inline double music_seconds(TimeNs time) {
  return static_cast<double>(time) / 1e9;
}

/// No stamp within 1 us after the begin of its interval, or before: NEST rounds stamps to its tic
/// of 1 us, takes an earlier one for the past, and blocks the channel for ever.
inline constexpr TimeNs kStampGuard = 1'000;

/// `stamp`, or the interval's begin + 1 us (its end, when it is shorter) when that is later.
TimeNs guarded_stamp(TimeNs stamp, const Interval& interval);

/// Collects the events that MUSIC's handlers bring until the loop takes them.
class SpikeInbox {
 public:
  explicit SpikeInbox(std::uint32_t width) : width_(width) {}

  /// `seconds` as the sender stamped it, any double; `id` any integer.
  void add(double seconds, int id);
  std::span<const Spike> spikes() const { return spikes_; }
  void clear() { spikes_.clear(); }

  std::uint64_t outside_port() const { return outside_port_; }  ///< dropped: id beyond the width
  std::uint64_t without_time() const { return without_time_; }  ///< dropped: no time, or 146 years

 private:
  std::uint32_t width_;
  std::vector<Spike> spikes_;
  std::uint64_t outside_port_ = 0;
  std::uint64_t without_time_ = 0;
};

/// Moves spikes to later times: those that MUSIC brings early wait here until they are due, those
/// that it brings late are no longer late.
class SpikeDelay {
 public:
  explicit SpikeDelay(TimeNs delay) : delay_(delay) {}

  /// The spikes that are due by the interval's end, with their new times; valid until the next
  /// call.
  std::span<const Spike> pass(std::span<const Spike> spikes, const Interval& interval);

 private:
  TimeNs delay_;
  std::vector<Spike> waiting_;
  std::vector<Spike> due_;
};

/// Gives a block of numbers without validity or revision both: all NaN is "no value yet", and a
/// change of any bit is a new revision.
class SignalBlock {
 public:
  explicit SignalBlock(std::uint32_t width)
      : values_(width, std::numeric_limits<double>::quiet_NaN()) {}

  /// True when `values` differs from the last time.
  bool update(std::span<const double> values);
  std::span<const double> values() const { return values_; }
  /// 0 while invalid. Never used twice, so that a value after a gap is news to everyone.
  std::uint64_t revision() const { return valid_ ? count_ : 0; }

 private:
  std::vector<double> values_;
  std::uint64_t count_ = 0;
  bool valid_ = false;
};

}  // namespace spikeloop::music
