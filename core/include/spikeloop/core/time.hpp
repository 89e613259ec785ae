// Simulated time: whole nanoseconds, converted once at the border.
#pragma once

#include <cstdint>
#include <limits>
#include <string>

namespace spikeloop {

/// Simulated time in nanoseconds since the run began.
using TimeNs = std::int64_t;

inline constexpr TimeNs kNsPerSecond = 1'000'000'000;
/// Later than every time of a run.
inline constexpr TimeNs kNever = std::numeric_limits<TimeNs>::max();

/// The interval (begin, end] that a node advances over: open on the left, closed on the right, as
/// in NEST. A spike stamped exactly `begin` belongs to the interval before. The interval is
/// computed when the clock shows `begin`.
struct Interval {
  TimeNs begin = 0;
  TimeNs end = 0;

  TimeNs length() const { return end - begin; }
  bool contains(TimeNs time) const { return time > begin && time <= end; }
};

/// Nearest nanosecond; exact to 1 ns for |seconds| below 2^53 ns (104 days).
/// @throws ConfigurationError when `seconds` is not finite or beyond the range of TimeNs.
TimeNs from_seconds(double seconds);

/// Seconds, as transports outside (MUSIC, ROS) carry them.
inline double to_seconds(TimeNs time) {
  return static_cast<double>(time) * 1e-9;
}

/// A tick length given in seconds: at least 1 ns and a whole number of nanoseconds.
/// @throws ConfigurationError with the value and the nearest valid one.
TimeNs tick_from_seconds(double seconds);

/// "1.5 ms", "20 s", "3 ns": the largest unit that leaves no more than three decimals.
std::string format_time(TimeNs time);

}  // namespace spikeloop
