// `time_to_first_spike_encoder`: the larger the value, the earlier its spike (Thorpe, Delorme & Van
// Rullen 2001).
#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <vector>

#include "encoder_input.hpp"
#include "held_input.hpp"
#include "parameter_checks.hpp"
#include "spikeloop/core/node.hpp"

namespace spikeloop {

namespace {

constexpr double kShortest = 1e-6;  // s; stamps keep away from the begin of an interval

// The first multiple of `period` at or after `time`, which is not negative.
TimeNs multiple_from(TimeNs time, TimeNs period) {
  return (time + period - 1) / period * period;
}

class TimeToFirstSpikeEncoder final : public Node {
 public:
  explicit TimeToFirstSpikeEncoder(const NodeSetup& setup)
      : input_(setup, initial_of_encoder(setup.parameters, InputPolicy(setup).passes())),
        period_(from_seconds(setup.parameters.number("period"))),
        t_min_(setup.parameters.number("t_min")),
        t_max_(setup.parameters.number("t_max")),
        threshold_(number_or_word(setup.parameters, "threshold", "none",
                                  "write a value from -1 to 1, or none for a spike of every value")
                       .value_or(-std::numeric_limits<double>::infinity())),
        due_(setup.widths[0], kNever) {
    require_at_most(setup.parameters, "t_min", "t_max");
    require_at_most(setup.parameters, "t_max", "period");
  }

  void step(const Step& step) override {
    const Interval interval = step.interval();
    input_.update(step, [this](std::size_t c, double) {
      if (std::isnan(input_[c])) {
        due_[c] = kNever;
      }
    });
    // A spike is never later than the begin of the next window: one a channel is due at a time.
    for (TimeNs start = multiple_from(interval.begin, period_); start < interval.end;
         start += period_) {
      emit_until(start);
      begin_window(start);
    }
    emit_until(interval.end);
    if (!emitted_.empty()) {
      step.spike_output().emit(emitted_);
      spikes_ += emitted_.size();
      emitted_.clear();
    }
  }

  std::vector<Counter> counters() const override {
    std::vector<Counter> counters = {{"spikes", spikes_}};
    input_.append_counters(counters);
    return counters;
  }

 private:
  void begin_window(TimeNs start) {
    for (std::size_t c = 0; c < due_.size(); ++c) {
      const double x = input_[c];
      due_[c] = x >= threshold_ ? start + latency(x) : kNever;  // NaN is not above anything
      earliest_ = std::min(earliest_, due_[c]);
    }
  }

  TimeNs latency(double x) const {
    const double exact = (t_min_ + (t_max_ - t_min_) * ((1 - x) / 2)) * 1e9;
    const double within = std::clamp(exact, kShortest * 1e9, static_cast<double>(period_));
    return std::llround(within);
  }

  void emit_until(TimeNs end) {
    if (earliest_ > end) {
      return;
    }
    earliest_ = kNever;
    for (std::size_t c = 0; c < due_.size(); ++c) {
      if (due_[c] <= end) {
        emitted_.push_back(make_spike(due_[c], static_cast<std::int32_t>(c)));
        due_[c] = kNever;
      }
      earliest_ = std::min(earliest_, due_[c]);
    }
  }

  HeldInput input_;
  TimeNs period_;
  double t_min_;  // s
  double t_max_;  // s
  double threshold_;
  std::vector<TimeNs> due_;
  TimeNs earliest_ = kNever;
  std::vector<Spike> emitted_;
  std::uint64_t spikes_ = 0;
};

std::vector<ParameterDescription> parameters_of_latency() {
  std::vector<ParameterDescription> parameters = {
      number_parameter("period", "s", "0.1", 1e-5, 1e6,
                       "Window length; windows start at its multiples"),
      number_parameter("t_min", "s", "0.001", kShortest, 1e6, "Spike latency for the value 1"),
      number_parameter("t_max", "s", "0.05", kShortest, 1e6, "Spike latency for the value -1"),
      number_or_word_parameter("threshold", "none",
                               "Values below it emit no spike; none: every value emits one"),
      initial_of_encoder_parameter()};
  append_encoder_input_policy(parameters);
  const auto range = std::ranges::find(parameters, "out_of_range", &ParameterDescription::name);
  range->text =
      "Input values outside [-1, 1], including infinity: clip, extrapolate (latencies from 1 us to "
      "the period), or end the run with an error";
  return parameters;
}

}  // namespace

/// Time is divided into windows that begin at the multiples of `period`. The value x that a channel
/// holds at a window's begin s gives one spike at
///     s + t_min + (t_max - t_min) (1 - x) / 2:
/// t_min after it for x = 1, t_max for x = -1; none for x below `threshold`. A value that comes
/// within a window counts from the next one on. When the input becomes invalid there are no more
/// spikes, also in the window that has begun. Under out_of_range = pass, latencies are extrapolated
/// within 1 us and the period.
NodeClass time_to_first_spike_encoder_class() {
  NodeDescription description;
  description.name = "time_to_first_spike_encoder";
  description.text = "One spike per value and window; larger values spike earlier";
  description.source = "Thorpe, Delorme & Van Rullen 2001";
  description.ports = encoder_ports();
  description.parameters = parameters_of_latency();
  return {description,
          [](const NodeSetup& setup) { return std::make_unique<TimeToFirstSpikeEncoder>(setup); }};
}

}  // namespace spikeloop
