// Reasons for which a robot is stopped.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace spikeloop::command {

enum class StopReason : std::uint8_t {
  no_value,           ///< the input has lost its value
  not_finite,         ///< NaN or infinity among the values of a command
  stale,              ///< the data behind the command are too old
  sensor_silent,      ///< a sensor that the command depends on sends nothing
  spikes_silent,      ///< no spike on the way to the command
  silent,             ///< the loop has not ticked for too long
  continued,          ///< SIGCONT: a program of the job has died, or this process was stopped
  emergency,          ///< the emergency stop is pressed
  emergency_unknown,  ///< no program reports whether the emergency stop is pressed
  stop_button,        ///< STOP is pressed in the live view
  suspended,          ///< Ctrl-Z has suspended the launcher
  unsupervised,       ///< the launcher, or a process between it and this one, is silent
  unguarded,          ///< no guard answers, and the command requires one
  terminated,         ///< SIGTERM, SIGINT, or an error
  ended               ///< the run is over
};
inline constexpr std::size_t kStopReasons = 15;

/// Name of the reason in counters.
constexpr std::string_view stop_reason_name(StopReason reason) {
  constexpr std::array<std::string_view, kStopReasons> names = {
      "without_value", "not_finite",     "data_too_old",
      "sensor_silent", "no_spike",       "no_tick",
      "continued",     "emergency_stop", "emergency_stop_unknown",
      "stop_button",   "suspended",      "unsupervised",
      "unguarded",     "terminated",     "ended"};
  return names[static_cast<std::size_t>(reason)];
}

}  // namespace spikeloop::command
