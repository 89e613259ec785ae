// What the simulated clock shows when a sensor's own clock shows a stamp.
#pragma once

#include <cstdint>

#include "spikeloop/core/time.hpp"

namespace spikeloop::messages {

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

}  // namespace spikeloop::messages
