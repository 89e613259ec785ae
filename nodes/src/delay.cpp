// `delay`: a signal, some time later.
#include <algorithm>
#include <deque>
#include <memory>
#include <vector>

#include "held_input.hpp"
#include "parameter_checks.hpp"
#include "spikeloop/core/node.hpp"

namespace spikeloop {

namespace {

class Delay final : public Node {
 public:
  explicit Delay(const NodeSetup& setup)
      : input_(setup), delay_(from_seconds(setup.parameters.number("delay"))) {}

  void step(const Step& step) override {
    const TimeNs now = step.interval().begin;
    if (input_.update(step)) {
      remember(now, step.signal_input().valid());
    }
    if (past_.empty() || past_.front().time > now - delay_) {
      return;
    }
    while (past_.size() > 1 && past_[1].time <= now - delay_) {
      past_.pop_front();
    }
    show(step.signal_output());
    past_.pop_front();
  }

  std::vector<Counter> counters() const override {
    std::vector<Counter> counters = {{"updates", updates_}};
    input_.append_counters(counters);
    return counters;
  }

 private:
  struct Revision {
    TimeNs time;
    std::vector<double> values;  // empty: the input became invalid
  };

  void remember(TimeNs now, bool valid) {
    past_.push_back({now, std::vector<double>(valid ? input_.channels() : 0)});
    if (valid) {
      input_.copy_to(past_.back().values);
    }
  }

  void show(const SignalOutput& output) {
    const std::vector<double>& values = past_.front().values;
    if (values.empty()) {
      output.invalidate();
      return;
    }
    std::ranges::copy(values, output.values().begin());
    output.commit();
    ++updates_;
  }

  HeldInput input_;
  TimeNs delay_;
  std::deque<Revision> past_;  // what has not been shown yet
  std::uint64_t updates_ = 0;
};

}  // namespace

/// During (t, t+dt] the output is what the input was from t - delay on: the newest value at or
/// before it, valid or not; invalid until there is one. So a change at s shows in the first
/// interval that begins at s + delay or later. Memory grows with the revisions within one delay.
NodeClass delay_class() {
  NodeDescription description;
  description.name = "delay";
  description.text = "Delays a signal by a whole number of ticks";
  description.source = "y(t) = x(t - delay)";
  description.ports = {
      {"in", PortKind::signal, Direction::input, {}, "The values to delay"},
      {"out", PortKind::signal, Direction::output, WidthRule::same_as(0), "The delayed values"}};
  description.parameters = {number_parameter("delay", "s", "0.1", 0, 1e6, "Delay of the output")};
  append_finite_input_policy(description.parameters);
  return {description, [](const NodeSetup& setup) { return std::make_unique<Delay>(setup); }};
}

}  // namespace spikeloop
