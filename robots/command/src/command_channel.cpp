#include "spikeloop/command/command_channel.hpp"

#include <algorithm>
#include <cmath>
#include <string>

namespace spikeloop::command {
namespace {

bool is_from_loop(StopReason reason) {
  return reason <= StopReason::stale;
}
bool is_final(StopReason reason) {
  return reason >= StopReason::terminated;
}

}  // namespace

std::string_view stop_reason_name(StopReason reason) {
  static constexpr std::array<std::string_view, kStopReasons> names = {
      "without_value", "not_finite", "data_too_old", "no_tick", "continued", "terminated", "ended"};
  return names[static_cast<std::size_t>(reason)];
}

CommandChannel::CommandChannel(const GateSettings& settings, Publish publish)
    : gate_(settings), publish_(std::move(publish)), zero_(settings.deadband.size(), 0.0) {}

TimeNs CommandChannel::command(std::span<const double> values, TimeNs now) {
  if (!std::ranges::all_of(values, [](double value) { return std::isfinite(value); })) {
    const bool nothing =
        std::ranges::all_of(values, [](double value) { return std::isnan(value); });
    return stop(nothing ? StopReason::no_value : StopReason::not_finite, now);
  }
  const std::lock_guard lock(mutex_);
  if (state_ == State::closed) {
    return kNever;
  }
  // Whatever else has stopped the robot since then.
  if (now < suspended_until_) {
    return state_ == State::stopped ? gate_.next_due() : kNever;
  }
  if (state_ != State::running) {
    resumed_ += state_ == State::idle ? 0 : 1;
    state_ = State::running;
    gate_.forget();
  }
  if (gate_.offer(values, now)) {
    ++commands_;
    publish_(gate_.current());
  }
  return gate_.next_due();
}

TimeNs CommandChannel::stop(StopReason reason, TimeNs now) {
  const std::lock_guard lock(mutex_);
  if (state_ == State::closed || (state_ == State::idle && is_from_loop(reason))) {
    return kNever;
  }
  if (is_from_loop(reason) && state_ == State::stopped && reason_ == reason) {
    if (gate_.offer(zero_, now)) {
      publish_(zero_);
    }
    return gate_.next_due();
  }
  ++stops_[static_cast<std::size_t>(reason)];
  reason_ = reason;
  state_ = is_final(reason)       ? State::closed
           : is_from_loop(reason) ? State::stopped
                                  : State::suspended;
  if (reason == StopReason::continued) {
    suspended_until_ = now + kContinuedPause;
  }
  send_zero(now);
  return state_ == State::stopped ? gate_.next_due() : kNever;
}

void CommandChannel::send_zero(TimeNs now) {
  gate_.force(zero_, now);
  publish_(zero_);
}

TimeNs CommandChannel::poll(TimeNs now) {
  const std::lock_guard lock(mutex_);
  if (state_ != State::running && state_ != State::stopped) {
    return kNever;
  }
  if (gate_.poll(now)) {
    commands_ += state_ == State::running ? 1 : 0;
    publish_(gate_.current());
  }
  return gate_.next_due();
}

std::optional<StopReason> CommandChannel::stopped_by() const {
  const std::lock_guard lock(mutex_);
  const bool driven = state_ == State::running || state_ == State::idle;
  return driven ? std::nullopt : std::optional(reason_);
}

std::vector<Counter> CommandChannel::counters() const {
  const std::lock_guard lock(mutex_);
  std::vector<Counter> counters = {{"commands", commands_}, {"resumed", resumed_}};
  for (std::size_t i = 0; i < kStopReasons; ++i) {
    counters.push_back(
        {"stops_" + std::string(stop_reason_name(static_cast<StopReason>(i))), stops_[i]});
  }
  return counters;
}

}  // namespace spikeloop::command
