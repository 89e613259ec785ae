// The keys of a command adapter as what its sink wants.
#pragma once

#include "spikeloop/command/command_sink.hpp"
#include "spikeloop/command/component_map.hpp"
#include "spikeloop/core/parameters.hpp"

namespace spikeloop::command {

struct LoopClock {
  TimeNs tick = 0;  ///< simulated
  double real_time_factor = 1;
};

/// Of the keys deadband, min_interval, watchdog, max_age; `command_rate` in Hz of simulated time,
/// 0: never again. Not written, min_interval is a tick of wall time, at least 10 ms, less half a
/// tick's jitter, and watchdog 3 ticks, at least 0.1 s.
CommandSettings command_settings(const Parameters& keys, const ComponentMap& map,
                                 double command_rate, const LoopClock& clock, bool with_data_stamp);

/// The same keys, all but the watchdog in simulated time. In lockstep min_interval is 1 ms when it
/// is not written, and there is no watchdog, for a guard neither.
CommandSettings simulated_settings(const Parameters& keys, const ComponentMap& map,
                                   CommandClock clock, bool with_data_stamp);

}  // namespace spikeloop::command
