// A leaky integrate-and-fire neuron under a piecewise constant current, solved in closed form: the
// time of its next spike is known from the latest change of the current or spike, and between these
// nothing is computed. So no spike depends on ticks.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "spikeloop/core/time.hpp"

namespace spikeloop {

struct LifModel {
  double tau_ns;      ///< time constant of the membrane
  double resistance;  ///< mV / pA
  double threshold;   ///< mV above the resting potential, which is also the reset potential
  TimeNs refractory;
};

class LifNeuron {
 public:
  static constexpr TimeNs kNever = std::numeric_limits<TimeNs>::max();

  /// Has no current yet and keeps this potential (mV).
  explicit LifNeuron(double potential) : potential_(potential) {}

  /// The stamp of its next spike; kNever when there is none to come.
  TimeNs next() const { return next_; }

  /// From `now` on, the current is `current` (pA).
  void set_current(TimeNs now, double current, const LifModel& model) {
    const double target = model.resistance * current;
    // An equal current must not begin a new segment: rounding would depend on revisions.
    if (active_ && target == target_) {
      return;
    }
    advance(now, model);
    active_ = true;
    target_ = target;
    schedule(model);
  }

  /// From `now` on there is no current and no leak either.
  void rest(TimeNs now, const LifModel& model) {
    advance(now, model);
    active_ = false;
    next_ = kNever;
  }

  /// The spike at next() has been taken.
  void fire(const LifModel& model) {
    since_ = next_ + model.refractory;
    rest_ = after_;
    potential_ = 0;
    schedule(model);
  }

 private:
  // The potential at `now`; in the refractory period it stays as it is till its end.
  void advance(TimeNs now, const LifModel& model) {
    const double passed = static_cast<double>(now - since_) - rest_;
    if (passed <= 0) {
      return;
    }
    if (active_) {
      potential_ = target_ + (potential_ - target_) * std::exp(-passed / model.tau_ns);
    }
    since_ = now;
    rest_ = 0;
  }

  // The spike is stamped with the nearest nanosecond after `since_`; the difference is kept, so
  // that rounding never adds up.
  void schedule(const LifModel& model) {
    if (!(target_ > model.threshold)) {
      next_ = kNever;
      return;
    }
    const double left = (potential_ - target_) / (model.threshold - target_);
    const double wait = rest_ + model.tau_ns * std::log(std::max(1.0, left));
    const TimeNs whole = std::max<TimeNs>(1, static_cast<TimeNs>(wait + 0.5));
    next_ = since_ + whole;
    after_ = wait - static_cast<double>(whole);
  }

  double potential_;   // mV, at since_ + rest_
  double target_ = 0;  // mV, what the potential tends to
  TimeNs since_ = 0;
  double rest_ = 0;  // ns
  TimeNs next_ = kNever;
  double after_ = 0;  // ns: the exact time of the next spike, minus next_
  bool active_ = false;
};

}  // namespace spikeloop
