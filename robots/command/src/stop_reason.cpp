#include "spikeloop/command/stop_reason.hpp"

#include <array>

namespace spikeloop::command {

std::string_view stop_reason_name(StopReason reason) {
  static constexpr std::array<std::string_view, kStopReasons> names = {
      "without_value", "not_finite",     "data_too_old",
      "sensor_silent", "no_spike",       "no_tick",
      "continued",     "emergency_stop", "emergency_stop_unknown",
      "stop_button",   "suspended",      "unsupervised",
      "unguarded",     "terminated",     "ended"};
  return names[static_cast<std::size_t>(reason)];
}

}  // namespace spikeloop::command
