#include "spikeloop/command/command_channel.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

namespace spikeloop::command {
namespace {

bool is_from_loop(StopReason reason) {
  return reason < StopReason::silent;
}
bool is_final(StopReason reason) {
  return reason >= StopReason::terminated;
}
bool is_finite(std::span<const double> values) {
  return std::ranges::all_of(values, [](double value) { return std::isfinite(value); });
}
bool is_unknown(std::span<const double> values) {
  return std::ranges::all_of(values, [](double value) { return std::isnan(value); });
}

std::vector<Bounds> bounds_of(const CommandSettings& settings) {
  std::vector<Bounds> bounds = settings.bounds;
  bounds.resize(settings.gate.deadband.size());
  for (std::size_t i = 0; i < std::min(bounds.size(), settings.stops.size()); ++i) {
    bounds[i].zero_stops = !settings.stops[i].hold;
  }
  return bounds;
}

}  // namespace

CommandChannel::CommandChannel(const CommandSettings& settings, Publish publish)
    : gate_(settings.gate),
      limiter_(bounds_of(settings), settings.gate.deadband.size()),
      publish_(std::move(publish)),
      rules_(settings.stops),
      measured_(settings.gate.deadband.size()),
      override_timeout_(settings.manual.timeout) {
  rules_.resize(measured_.size());
  stop_ = computed_stop(0);
}

void CommandChannel::measure(std::span<const double> positions, TimeNs now) {
  const std::lock_guard lock(mutex_);
  for (std::size_t i = 0; i < positions.size(); ++i) {
    if (std::isfinite(positions[i])) {
      measured_[i] = {positions[i], now};
    }
  }
}

std::vector<double> CommandChannel::stop_values(TimeNs now) const {
  const std::lock_guard lock(mutex_);
  return state_ == State::stopped || state_ == State::closed ? stop_ : computed_stop(now);
}

std::vector<double> CommandChannel::computed_stop(TimeNs now) const {
  std::vector<double> values;
  for (std::size_t i = 0; i < rules_.size(); ++i) {
    const double commanded = driven_ ? gate_.last()[i] : std::numeric_limits<double>::quiet_NaN();
    const auto& [position, time] = measured_[i];
    const bool is_known = std::isfinite(position) && now - time <= kMeasuredAge;
    const double held = is_known ? position : commanded;
    values.push_back(rules_[i].hold ? held : rules_[i].value);
  }
  return values;
}

/// The stop command, with positions that have been measured since the stop.
std::vector<double> CommandChannel::known_stop(TimeNs now) const {
  std::vector<double> values = computed_stop(now);
  for (std::size_t i = 0; i < values.size(); ++i) {
    values[i] = std::isnan(stop_[i]) ? values[i] : stop_[i];
  }
  return values;
}

TimeNs CommandChannel::command(std::span<const double> values, TimeNs now) {
  if (!is_finite(values)) {
    return stop(is_unknown(values) ? StopReason::no_value : StopReason::not_finite, now);
  }
  const std::lock_guard lock(mutex_);
  if (state_ == State::closed) {
    return kNever;
  }
  network_stop_.reset();
  // The pause after SIGCONT lasts even if the robot was stopped for another reason since.
  if (held_ || now < suspended_until_) {
    return repeat(now);
  }
  return still_overridden(now) ? drive_by_hand(now) : drive(values, now);
}

TimeNs CommandChannel::stop(StopReason reason, TimeNs now) {
  const std::lock_guard lock(mutex_);
  if (state_ == State::closed) {
    return kNever;
  }
  if (reason <= StopReason::silent) {
    network_stop_ = reason;
    if (held_) {
      return repeat(now);
    }
    return still_overridden(now) ? drive_by_hand(now) : stop_network(reason, now);
  }
  overridden_ = false;
  if (reason == StopReason::continued) {
    suspended_until_ = now + kContinuedPause;
  }
  return halt(reason, now);
}

TimeNs CommandChannel::halt(StopReason reason, TimeNs now) {
  ++stops_[static_cast<std::size_t>(reason)];
  reason_ = reason;
  enter(is_final(reason) ? State::closed : State::stopped, now);
  send_stop(now);
  return next_due();
}

void CommandChannel::enter(State state, TimeNs now) {
  if (state_ == State::running || state_ == State::idle) {
    stop_ = computed_stop(now);
  }
  drives_ = state == State::running;
  const bool stops = state == State::stopped;
  if (stops && !stopped_since_) {
    stopped_since_ = now;
  } else if (!stops && stopped_since_) {
    stopped_time_ += now - *stopped_since_;
    stopped_since_.reset();
  }
  state_ = state;
}

void CommandChannel::allow_no_value() {
  const std::lock_guard lock(mutex_);
  may_lack_value_ = true;
}

TimeNs CommandChannel::stop_network(StopReason reason, TimeNs now) {
  if (std::exchange(may_lack_value_, false) && reason == StopReason::no_value &&
      state_ == State::running) {
    enter(State::idle, now);
    send_stop(now);
    return kNever;
  }
  if (state_ == State::idle && is_from_loop(reason)) {
    return kNever;
  }
  const bool lasts = is_from_loop(reason) && state_ == State::stopped && reason_ == reason;
  return lasts ? repeat(now) : halt(reason, now);
}

void CommandChannel::hold(std::optional<StopReason> reason, TimeNs now) {
  const std::lock_guard lock(mutex_);
  if (state_ == State::closed || reason == held_) {
    return;
  }
  held_ = reason;
  overridden_ = false;
  if (reason) {
    halt(*reason, now);
  } else if (!driven_) {
    enter(State::idle, now);
  } else if (network_stop_) {
    stop_network(*network_stop_, now);
  }
}

void CommandChannel::restart_commands(TimeNs now) {
  const std::lock_guard lock(mutex_);
  if (state_ == State::running) {
    gate_.forget();
    limiter_.restart(computed_stop(now), now);
  }
}

void CommandChannel::override_with(std::span<const double> values, TimeNs now) {
  const std::lock_guard lock(mutex_);
  if (state_ == State::closed || held_ || now < suspended_until_) {
    return;
  }
  overrides_ += still_overridden(now) ? 0 : 1;
  overridden_ = true;
  override_until_ = now + override_timeout_;
  override_.assign(values.begin(), values.end());
  if (is_finite(values)) {
    drive(override_, now);
  } else {
    halt(StopReason::not_finite, now);
  }
}

/// Repeats the stop command if a value is not finite; limits do not apply to such values.
TimeNs CommandChannel::drive_by_hand(TimeNs now) {
  return is_finite(override_) ? drive(override_, now) : repeat(now);
}

bool CommandChannel::still_overridden(TimeNs now) {
  overridden_ = overridden_ && now < override_until_;
  return overridden_;
}

TimeNs CommandChannel::drive(std::span<const double> values, TimeNs now) {
  may_lack_value_ = false;
  if (state_ != State::running) {
    resumed_ += state_ == State::idle ? 0 : 1;
    enter(State::running, now);
    gate_.forget();
    limiter_.restart(known_stop(now), now);
  }
  if (gate_.offer(limiter_.shape(values, now, overridden_), now)) {
    publish();
  }
  return next_due();
}

TimeNs CommandChannel::repeat(TimeNs now) {
  if ((state_ == State::stopped || state_ == State::running) && gate_.poll(now)) {
    publish();
  }
  return next_due();
}

void CommandChannel::send_stop(TimeNs now) {
  gate_.force(stop_, now);
  publish();
}

/// Sends no stop command with unknown positions: a robot that was never driven must not move.
void CommandChannel::publish() {
  const bool is_command = state_ == State::running;
  driven_ = driven_ || is_command;
  commands_ += is_command ? 1 : 0;
  if (is_command || !is_unknown(gate_.current())) {
    publish_(gate_.current());
  }
}

TimeNs CommandChannel::next_due() const {
  if (state_ != State::running && state_ != State::stopped) {
    return kNever;
  }
  return std::min(gate_.next_due(), overridden_ ? override_until_ : kNever);
}

TimeNs CommandChannel::poll(TimeNs now) {
  const std::lock_guard lock(mutex_);
  if (overridden_ && !still_overridden(now) && network_stop_) {
    return stop_network(*network_stop_, now);
  }
  return repeat(now);
}

void CommandChannel::repeat_stop(TimeNs now) {
  const std::lock_guard lock(mutex_);
  if (state_ == State::stopped) {
    send_stop(now);
  }
}

CommandChannel::Standing CommandChannel::standing() const {
  const std::lock_guard lock(mutex_);
  const bool driven = state_ == State::running || state_ == State::idle;
  return {driven ? std::nullopt : std::optional(reason_), overridden_, driven_};
}

CommandChannel::NetworkCommand CommandChannel::network_command() const {
  const std::lock_guard lock(mutex_);
  if (state_ != State::running || overridden_) {
    return NetworkCommand::unused;
  }
  return gate_.holds_back() ? NetworkCommand::held_back : NetworkCommand::sent;
}

TimeNs CommandChannel::stopped_time() const {
  const std::lock_guard lock(mutex_);
  return stopped_time_;
}

std::optional<Limiter::Cut> CommandChannel::first_cut() const {
  const std::lock_guard lock(mutex_);
  return limiter_.first_cut();
}

std::vector<Counter> CommandChannel::counters() const {
  const std::lock_guard lock(mutex_);
  std::vector<Counter> counters = {{"commands", commands_},
                                   {"sent", gate_.sent()},
                                   {"resumed", resumed_},
                                   {"overrides", overrides_},
                                   {"limited", limiter_.cuts()}};
  for (std::size_t i = 0; i < kStopReasons; ++i) {
    counters.push_back(
        {"stops_" + std::string(stop_reason_name(static_cast<StopReason>(i))), stops_[i]});
  }
  return counters;
}

}  // namespace spikeloop::command
