// What "wait" means in the loop: wait, receive, step, exchange, send.
#pragma once

#include <cstdint>
#include <memory>
#include <string_view>

#include "spikeloop/core/time.hpp"

namespace spikeloop {

/// Monotonic wall time in nanoseconds (CLOCK_MONOTONIC): the same in every process of a machine.
TimeNs wall_now();

/// Waits until simulated time may begin its next tick.
class Pacer {
 public:
  struct Report {
    std::uint64_t ticks = 0;
    std::uint64_t overruns = 0;  ///< ticks begun later than one tick after their time
    TimeNs worst_lateness = 0;   ///< wall time
    TimeNs wall_time = 0;        ///< since start()
  };
  virtual ~Pacer() = default;
  /// Simulated time 0 is now.
  virtual void start() = 0;
  /// Returns when the clock shows `time`.
  virtual void wait_until(TimeNs time) = 0;
  virtual Report report() const = 0;
};

/// The wall clock times `factor` (real-time factor): simulated = factor * wall. After a stall it
/// catches up at most the longer of 3 ticks and 100 ms; the schedule moves by what is beyond, so
/// that no burst of old ticks drives the robot.
/// @throws ConfigurationError when `factor` is not a number above 0.
std::unique_ptr<Pacer> make_realtime_pacer(double factor, TimeNs tick);
/// No waiting: batch runs, benchmarks, and every process that follows another one.
std::unique_ptr<Pacer> make_unpaced_pacer();

}  // namespace spikeloop
