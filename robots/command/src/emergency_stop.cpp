#include "spikeloop/command/emergency_stop.hpp"

namespace spikeloop::command {

void EmergencyRule::take(bool stop, TimeNs now) {
  stop_ = stop || (settings_.latched && stop_);
  heard_ = now;
}

std::optional<StopReason> EmergencyRule::verdict(bool has_publishers, TimeNs now) const {
  if (stop_) {
    return StopReason::emergency;
  }
  const bool silent = settings_.timeout != 0 && (!heard_ || now - *heard_ > settings_.timeout);
  if (silent || (settings_.required && !has_publishers)) {
    return StopReason::emergency_unknown;
  }
  return std::nullopt;
}

}  // namespace spikeloop::command
