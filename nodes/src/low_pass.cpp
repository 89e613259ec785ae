// `low_pass`: a first-order lag of each channel.
#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <vector>

#include "held_input.hpp"
#include "parameter_checks.hpp"
#include "spikeloop/core/node.hpp"

namespace spikeloop {

namespace {

class LowPass final : public Node {
 public:
  explicit LowPass(const NodeSetup& setup)
      : input_(setup),
        tau_(setup.parameters.number("tau") * 1e9),
        initial_(number_or_word(setup.parameters, "initial", "none",
                                "write a value, or none to begin at the first input")),
        segments_(setup.widths[0], {0, initial_.value_or(0.0), initial_.value_or(0.0)}) {}

  void step(const Step& step) override {
    const TimeNs now = step.interval().begin;
    input_.update(step, [&](std::size_t c, double before) { begin_segment(c, before, now); });
    const SignalOutput output = step.signal_output();
    if (step.signal_input().valid()) {
      write(output, step.interval().end);
    } else if (output.revision() != 0) {
      output.invalidate();
    }
  }

  std::vector<Counter> counters() const override {
    std::vector<Counter> counters = {{"updates", updates_}};
    input_.append_counters(counters);
    return counters;
  }

 private:
  // From `begin` on, the output goes from `from` to `to`.
  struct Segment {
    TimeNs begin;
    double from;
    double to;
  };

  void begin_segment(std::size_t c, double before, TimeNs now) {
    const double x = input_[c];
    const bool first = std::isnan(before);
    segments_[c] = {now, first ? initial_.value_or(x) : value(segments_[c], now),
                    std::isnan(x) ? 0.0 : x};
  }

  // std::lerp neither overflows nor leaves the way between its ends, and ends at `to` exactly.
  double value(const Segment& segment, TimeNs time) const {
    const double age = static_cast<double>(time - segment.begin) / tau_;
    return std::lerp(segment.from, segment.to, -std::expm1(-age));
  }

  void write(const SignalOutput& output, TimeNs end) {
    const std::span<double> values = output.values();
    bool changed = output.revision() == 0;
    for (std::size_t c = 0; c < values.size(); ++c) {
      const double now = value(segments_[c], end);
      changed |= now != values[c];
      values[c] = now;
    }
    if (changed) {
      output.commit();
      ++updates_;
    }
  }

  HeldInput input_;
  double tau_;  // ns
  std::optional<double> initial_;
  std::vector<Segment> segments_;
  std::uint64_t updates_ = 0;
};

}  // namespace

/// tau dy/dt = x - y, solved exactly for the piecewise constant input:
///     y(t) = x + (y(t0) - x) exp(-(t - t0) / tau)
/// from the latest change of x, at t0. `out` is y at the interval's end; it has a new revision only
/// while it changes. A channel begins, with its first value or with the first after the input was
/// invalid, at `initial`, or there and then.
NodeClass low_pass_class() {
  NodeDescription description;
  description.name = "low_pass";
  description.text = "Smooths each channel with a first-order low-pass filter";
  description.source = "tau dy/dt = x - y";
  description.ports = {
      {"in", PortKind::signal, Direction::input, {}, "The values to smooth"},
      {"out", PortKind::signal, Direction::output, WidthRule::same_as(0), "The smoothed values"}};
  description.parameters = {
      number_parameter("tau", "s", "0.1", 1e-6, 1e6, "Time constant of the filter"),
      number_or_word_parameter("initial", "none",
                               "Output when the first value arrives; none: that value")};
  append_finite_input_policy(description.parameters);
  return {description, [](const NodeSetup& setup) { return std::make_unique<LowPass>(setup); }};
}

}  // namespace spikeloop
