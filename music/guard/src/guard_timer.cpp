#include "spikeloop/guard/guard_timer.hpp"

#include <algorithm>

namespace spikeloop::guard {

TimeNs deadline_for(TimeNs watchdog) {
  // A watchdog of years must not overflow.
  return std::clamp<TimeNs>(watchdog, 0, kNever / 4) + kMargin;
}

GuardTimer::GuardTimer(TimeNs watchdog, TimeNs now)
    : deadline_(deadline_for(watchdog)), last_beat_(now) {}

void GuardTimer::beat(TimeNs now) {
  if (state_ == State::over || cause_ == Cause::lost) {
    return;
  }
  // Cancel the remaining stop commands: after SIGCONT the adapter sends its own, and pauses.
  state_ = State::watching;
  cause_.reset();
  robot_stopped_ = false;
  last_beat_ = now;
}

void GuardTimer::done() {
  if (cause_ != Cause::lost) {
    state_ = State::over;
    cause_.reset();
  }
}

void GuardTimer::lost(TimeNs now) {
  if (state_ != State::over && cause_ != Cause::lost) {
    begin(Cause::lost, now);
  }
}

void GuardTimer::begin(Cause cause, TimeNs now) {
  state_ = State::stopping;
  cause_ = cause;
  stopping_since_ = now;
  next_zero_ = now;
  zeros_left_ = kZeros;
}

bool GuardTimer::poll(TimeNs now, bool has_subscriber) {
  if (state_ == State::watching && now - last_beat_ > deadline_) {
    begin(Cause::silent, now);
  }
  if (state_ != State::stopping || now < next_zero_) {
    return false;
  }
  next_zero_ = now + kZeroInterval;
  zeros_left_ -= has_subscriber ? 1 : 0;
  robot_stopped_ = robot_stopped_ || has_subscriber;
  if (zeros_left_ == 0 || now - stopping_since_ >= kLongestStop) {
    state_ = cause_ == Cause::lost ? State::over : State::silent;
  }
  return true;
}

TimeNs GuardTimer::next_due() const {
  switch (state_) {
    case State::watching:
      return last_beat_ + deadline_ + 1;
    case State::stopping:
      return next_zero_;
    case State::silent:
    case State::over:
      break;
  }
  return kNever;
}

}  // namespace spikeloop::guard
