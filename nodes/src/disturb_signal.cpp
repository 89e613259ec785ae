// `disturb_signal`: noise, bias, lost values and a frozen signal, to measure robustness.
#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <vector>

#include "disturbance.hpp"
#include "parameter_checks.hpp"
#include "spikeloop/core/node.hpp"
#include "spikeloop/core/random.hpp"

namespace spikeloop {

namespace {

class DisturbSignal final : public Node {
 public:
  explicit DisturbSignal(const NodeSetup& setup)
      : period_(setup.parameters),
        random_(setup.noise_seed(), setup.name),
        noise_(setup.parameters.number("noise")),
        bias_(setup.parameters.number("bias")),
        drop_(setup.parameters.number("drop")),
        freeze_(setup.parameters.boolean("freeze")) {}

  void step(const Step& step) override {
    const SignalInput input = step.signal_input();
    const bool active = period_.contains(step.interval().end);
    const bool changed = input.revision != seen_ || active != was_active_ || (altered_ && active);
    if (!changed || (active && freeze_)) {
      return;
    }
    altered_ = false;
    was_active_ = active;
    seen_ = input.revision;
    const SignalOutput output = step.signal_output();
    if (!input.valid()) {
      output.invalidate();
      return;
    }
    for (std::size_t c = 0; c < input.values.size(); ++c) {
      output.values()[c] = active ? disturbed(c, input.values[c], output) : input.values[c];
    }
    output.commit();
    ++updates_;
  }

  void change(std::string_view parameter, double value) override {
    (parameter == "noise" ? noise_ : parameter == "bias" ? bias_ : drop_) = value;
    altered_ = true;
  }

  std::vector<Counter> counters() const override {
    return {{"updates", updates_}, {"dropped", dropped_}};
  }

 private:
  static constexpr std::uint64_t kDraws = 3;  // of a channel, each update

  double disturbed(std::size_t channel, double value, const SignalOutput& output) {
    const std::uint64_t draw = kDraws * updates_;
    if (drop_ > 0 && output.revision() != 0 && random_.uniform(channel, draw) <= drop_) {
      ++dropped_;
      return output.values()[channel];
    }
    if (noise_ > 0) {  // Box and Muller 1958
      value += noise_ * std::sqrt(-2 * std::log(random_.uniform(channel, draw + 1))) *
               std::cos(2 * std::numbers::pi * random_.uniform(channel, draw + 2));
    }
    return value + bias_;
  }

  Disturbance period_;
  RandomStream random_;
  double noise_;
  double bias_;
  double drop_;
  bool freeze_;
  bool was_active_ = false;
  bool altered_ = false;
  std::uint64_t seen_ = 0;
  std::uint64_t updates_ = 0;
  std::uint64_t dropped_ = 0;
};

}  // namespace

/// In ticks that end in (from, to] a value becomes value + bias + noise * N(0, 1), with independent
/// numbers for every channel and update; with the probability `drop` a channel keeps its previous
/// output instead. With `freeze` nothing changes. In other ticks the values pass. A begin or end of
/// the disturbance is an update of the output, too.
NodeClass disturb_signal_class() {
  NodeDescription description;
  description.name = "disturb_signal";
  description.text = "Adds noise and a bias to a signal, loses values, or freezes it";
  description.source = "y = x + bias + noise * N(0, 1)";
  description.ports = {
      {"in", PortKind::signal, Direction::input, {}, "The values to disturb"},
      {"out", PortKind::signal, Direction::output, WidthRule::same_as(0), "The disturbed values"}};
  description.parameters = {
      changeable(number_parameter("noise", "1", "0", 0, 1e6,
                                  "Standard deviation of the noise of each value")),
      changeable(number_parameter("bias", "1", "0", -1e6, 1e6, "What is added to each value")),
      changeable(
          number_parameter("drop", "1", "0", 0, 1,
                           "Probability that a channel keeps its old value when a new one comes")),
      {.name = "freeze",
       .type = ParameterType::boolean,
       .default_value = "false",
       .text = "The output does not change"}};
  append_disturbance_period(description.parameters);
  return {description,
          [](const NodeSetup& setup) { return std::make_unique<DisturbSignal>(setup); }};
}

}  // namespace spikeloop
