#include "spikeloop/command/command_gate.hpp"

#include <algorithm>
#include <cmath>

namespace spikeloop::command {

CommandGate::CommandGate(GateSettings settings)
    : settings_(std::move(settings)),
      current_(settings_.deadband.size()),
      last_(settings_.deadband.size()) {
  if (settings_.period != 0) {
    settings_.period = std::max(settings_.period, settings_.min_interval);
  }
}

bool CommandGate::moved() const {
  for (std::size_t i = 0; i < current_.size(); ++i) {
    // A change to exactly zero is a stop. It is sent even within the deadband.
    const bool stops = current_[i] == 0.0 && last_[i] != 0.0;
    if (stops || std::fabs(current_[i] - last_[i]) > settings_.deadband[i]) {
      return true;
    }
  }
  return false;
}

TimeNs CommandGate::due(TimeNs more_grace) const {
  if (!any_) {
    return kNever;
  }
  if (!sent_) {
    return std::numeric_limits<TimeNs>::min();
  }
  if (forced_) {
    const TimeNs period = settings_.period == 0 ? kLongestRepetition : settings_.period;
    return last_time_ + std::max({std::min(period, kLongestRepetition), kShortestRepetition,
                                  settings_.min_interval});
  }
  if (moved()) {
    return last_change_ + settings_.min_interval - settings_.tolerance;
  }
  if (settings_.period == 0) {
    return kNever;
  }
  const bool is_first = last_time_ == last_change_;
  return last_time_ + settings_.period + (is_first ? settings_.grace : 0) + more_grace;
}

bool CommandGate::send(TimeNs now) {
  if (!sent_ || moved()) {
    last_change_ = now;
  }
  last_ = current_;
  last_time_ = now;
  sent_ = true;
  ++sent_count_;
  return true;
}

bool CommandGate::offer(std::span<const double> command, TimeNs now) {
  std::ranges::copy(command, current_.begin());
  any_ = true;
  forced_ = false;
  return now >= due(0) && send(now);
}

bool CommandGate::poll(TimeNs now) {
  return now >= next_due() && send(now);
}

TimeNs CommandGate::next_due() const {
  return due(settings_.poll_grace);
}

void CommandGate::force(std::span<const double> command, TimeNs now) {
  std::ranges::copy(command, current_.begin());
  any_ = true;
  forced_ = true;
  send(now);
}

void CommandGate::forget() {
  any_ = false;
  sent_ = false;
  forced_ = false;
}

}  // namespace spikeloop::command
