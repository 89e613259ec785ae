#include "spikeloop/command/operator_input.hpp"

#include <utility>

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

void OperatorInput::watch_publishers(std::function<bool()> has_publishers) {
  const std::lock_guard lock(asking_);
  has_publishers_ = std::move(has_publishers);
}

void OperatorInput::emergency(bool stop, TimeNs wall) {
  const std::lock_guard lock(mutex_);
  rule_.take(stop, wall);
}

void OperatorInput::press_stop(bool pressed) {
  const std::lock_guard lock(mutex_);
  stop_pressed_ = pressed;
}

void OperatorInput::set_lost_supervision(std::optional<StopReason> reason) {
  const std::lock_guard lock(mutex_);
  lost_supervision_ = reason;
}

void OperatorInput::override_with(std::span<const double> values) {
  const std::lock_guard lock(mutex_);
  manual_.emplace(values.begin(), values.end());
}

void OperatorInput::apply(TimeNs wall, TimeNs now) {
  bool published = false;
  {
    const std::lock_guard lock(asking_);
    published = has_publishers_ && has_publishers_();
  }
  const std::lock_guard lock(mutex_);
  std::optional<StopReason> reason = rule_.verdict(published, wall);
  if (stop_pressed_) {
    reason = StopReason::stop_button;
  }
  channel_.hold(reason ? reason : lost_supervision_, now);
  if (manual_) {
    channel_.override_with(*manual_, now);
    manual_.reset();
  }
}

}  // namespace spikeloop::command
