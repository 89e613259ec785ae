#include "spikeloop/core/time.hpp"
#include "spikeloop/core/code.hpp"

#include <fmt/format.h>

#include <cmath>
#include <cstdlib>

#include "spikeloop/core/error.hpp"

namespace spikeloop {

namespace {
constexpr double kLargestSeconds = 9.0e9;  // 285 years: below the range of int64 nanoseconds
}

TimeNs from_seconds(double seconds) {
  if (!std::isfinite(seconds) || std::abs(seconds) > kLargestSeconds) {
    throw ConfigurationError(with_code(
        Code::out_of_bounds,
        "a time of {} s cannot be represented; write a finite number of seconds below {:g}",
        seconds, kLargestSeconds));
  }
  return static_cast<TimeNs>(std::llround(seconds * 1e9));
}

TimeNs tick_from_seconds(double seconds) {
  const TimeNs tick = from_seconds(seconds);
  const double error_ns = std::abs(seconds * 1e9 - static_cast<double>(tick));
  if (tick < 1 || error_ns > 1e-3) {
    throw ConfigurationError(
        with_code(Code::off_grid,
                  "a tick of {} s is not a whole number of nanoseconds above 0; write for "
                  "example {} s",
                  seconds, tick < 1 ? 0.001 : to_seconds(tick)));
  }
  return tick;
}

std::string format_time(TimeNs time) {
  struct Unit {
    TimeNs length;
    const char* name;
  };
  constexpr Unit kUnits[] = {{kNsPerSecond, "s"}, {1'000'000, "ms"}, {1'000, "us"}, {1, "ns"}};
  for (const Unit& unit : kUnits) {
    if (std::abs(time) >= unit.length) {
      return fmt::format("{} {}", static_cast<double>(time) / static_cast<double>(unit.length),
                         unit.name);
    }
  }
  return time == 0 ? "0 s" : fmt::format("{} ns", time);
}

}  // namespace spikeloop
