// Why a robot stands.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>

namespace spikeloop::command {

enum class StopReason : std::uint8_t {
  no_value,           ///< the input has lost its value
  not_finite,         ///< NaN or infinity among the command's values
  stale,              ///< the data behind the command are too old
  sensor_silent,      ///< a sensor that the command depends on brings nothing
  spikes_silent,      ///< no spike has come on the way to the command
  silent,             ///< the loop has not ticked for too long
  continued,          ///< SIGCONT: mpirun has seen a program die, or somebody had stopped us
  emergency,          ///< the emergency stop says so
  emergency_unknown,  ///< nobody says whether the emergency stop is pressed
  stop_button,        ///< STOP is pressed in the live view
  suspended,          ///< Ctrl-Z has suspended the launcher
  unsupervised,       ///< the launcher, or what is between it and this process, is silent
  unguarded,          ///< no guard answers, and the command requires one
  terminated,         ///< SIGTERM, SIGINT, or an error
  ended               ///< the run is over
};
inline constexpr std::size_t kStopReasons = 15;

/// "data_too_old", ...: the name in counters.
std::string_view stop_reason_name(StopReason reason);

}  // namespace spikeloop::command
