// `step_forward_encoder`: a spike for every step that the input has gone up or down (Kasabov et al.
// 2016; Petro, Kasabov & Kiss 2020, step-forward encoding; delta modulation).
#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <vector>

#include "held_input.hpp"
#include "paired_channels.hpp"
#include "parameter_checks.hpp"
#include "spikeloop/core/node.hpp"

namespace spikeloop {

namespace {

// What one input's spikes have told so far, and when the next one is due.
struct Follower {
  double first_base = std::numeric_limits<double>::quiet_NaN();  // NaN: no value has come
  std::int64_t steps = 0;  // base = first_base + steps * threshold: nothing is added up
  TimeNs last = -1;        // of the latest spike; -1: none
  TimeNs due = kNever;     // of the next spike
  int direction = 0;       // of the next spike: 1, -1; 0: none is due
};

class StepForwardEncoder final : public Node {
 public:
  explicit StepForwardEncoder(const NodeSetup& setup)
      : input_(setup),
        threshold_(setup.parameters.number("threshold")),
        min_interval_(from_seconds(setup.parameters.number("min_interval"))),
        followers_(setup.widths[0]) {
    require_paired_channels(setup);
    const std::optional<double> base =
        number_or_word(setup.parameters, "initial_base", "none",
                       "write a value, or none for each channel's first value");
    for (Follower& follower : followers_) {
      follower.first_base = base.value_or(follower.first_base);
    }
  }

  void step(const Step& step) override {
    const Interval interval = step.interval();
    const TimeNs end = interval.end;
    input_.update(step, [&](std::size_t c, double) { compare(c, interval.begin); });
    if (earliest_ > end) {
      return;
    }
    earliest_ = kNever;
    for (std::size_t c = 0; c < followers_.size(); ++c) {
      while (followers_[c].due <= end) {
        fire(c);
      }
      earliest_ = std::min(earliest_, followers_[c].due);
    }
    step.spike_output().emit(emitted_);
    spikes_ += emitted_.size();
    emitted_.clear();
  }

  std::vector<Counter> counters() const override {
    std::vector<Counter> counters = {{"spikes", spikes_}};
    input_.append_counters(counters);
    return counters;
  }

 private:
  // 1: the input is a threshold or more above the base, -1: below, 0: neither, or no value.
  int direction_of(std::size_t c) const {
    const Follower& follower = followers_[c];
    const double away = input_[c] - follower.first_base;
    // In this form ten steps of 0.1 reach exactly 1.
    const auto level = [&](std::int64_t steps) { return static_cast<double>(steps) * threshold_; };
    return away >= level(follower.steps + 1) ? 1 : away <= level(follower.steps - 1) ? -1 : 0;
  }

  // The input of channel c has another value from `now` on, or none.
  void compare(std::size_t c, TimeNs now) {
    Follower& follower = followers_[c];
    if (std::isnan(follower.first_base)) {
      follower.first_base = input_[c];
    }
    const int direction = direction_of(c);
    if (direction == follower.direction) {
      return;  // a spike that is due stays due: the change before is its cause
    }
    follower.direction = direction;
    follower.due = direction == 0 ? kNever : std::max(now + kReaction, after_last(follower));
    earliest_ = std::min(earliest_, follower.due);
  }

  void fire(std::size_t c) {
    Follower& follower = followers_[c];
    emitted_.push_back(make_spike(follower.due, paired_channel(c, follower.direction > 0)));
    follower.steps += follower.direction;
    follower.last = follower.due;
    follower.direction = direction_of(c);
    follower.due = follower.direction == 0 ? kNever : after_last(follower);
  }

  TimeNs after_last(const Follower& follower) const {
    return follower.last < 0 ? 0 : follower.last + min_interval_;
  }

  HeldInput input_;
  double threshold_;
  TimeNs min_interval_;
  std::vector<Follower> followers_;
  TimeNs earliest_ = kNever;
  std::vector<Spike> emitted_;
  std::uint64_t spikes_ = 0;
};

}  // namespace

/// Channel d has a base. While the input is a `threshold` or more above it, the output's channel 2d
/// spikes and the base goes up by one threshold; while it is as far below, channel 2d+1 spikes and
/// the base goes down. The first spike comes 1 us after the change that makes it due, and the
/// spikes of one input follow each other at distances of at least `min_interval`; if the input
/// changes meanwhile, the comparison goes on with the new value. So the base is never a threshold
/// away from an input that has rested for long enough, and adding up the spikes gives the base.
NodeClass step_forward_encoder_class() {
  NodeDescription description;
  description.name = "step_forward_encoder";
  description.text = "One spike per step by which a value increases or decreases";
  description.source = "Kasabov et al. 2016; Petro, Kasabov & Kiss 2020, step-forward encoding";
  description.ports = paired_channel_ports();
  description.parameters = {
      number_parameter("threshold", "1", "0.1", 1e-9, 1e9, "Step size"),
      number_parameter("min_interval", "s", "0.001", 1e-6, 1e3,
                       "Shortest interval between spikes of one input"),
      number_or_word_parameter(
          "initial_base", "none",
          "Value with which the first input is compared; none: the first input itself")};
  append_finite_input_policy(description.parameters);
  return {description,
          [](const NodeSetup& setup) { return std::make_unique<StepForwardEncoder>(setup); }};
}

}  // namespace spikeloop
