// `winner_take_all`: which neuron fires most.
#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <optional>
#include <vector>

#include "kernel_sum.hpp"
#include "parameter_checks.hpp"
#include "signal_function.hpp"
#include "spike_moments.hpp"
#include "spikeloop/core/code.hpp"
#include "spikeloop/core/node.hpp"

namespace spikeloop {

namespace {

enum class Output { one_hot, index, rate };

Output output_of(const NodeSetup& setup) {
  const std::string& choice = setup.parameters.text("output");
  if (choice != "index") {
    require_equal_widths(setup);
    return choice == "rate" ? Output::rate : Output::one_hot;
  }
  if (setup.widths[1] != 1) {
    throw ConfigurationError(
        with_code(Code::widths_differ,
                  "port 'out' has {} channels, but an index is one value; write [1] in its "
                  "connection, or output = one_hot",
                  setup.widths[1]));
  }
  return Output::index;
}

class WinnerTakeAll final : public Node {
 public:
  explicit WinnerTakeAll(const NodeSetup& setup)
      : output_(output_of(setup)),
        tau_(setup.parameters.number("tau")),
        lead_(1 + setup.parameters.number("margin")),
        sum_(setup.widths[0], tau_),
        values_(setup.widths[1], 0.0) {}

  void step(const Step& step) override {
    moments_.take(step.spike_input(), step.interval(),
                  [this](TimeNs time, std::span<const Spike> spikes) { add(time, spikes); });
    if (winner_) {
      write(step.signal_output(), step.interval().end);
    }
  }

  std::vector<Counter> counters() const override {
    std::vector<Counter> counters = moments_.counters();
    counters.push_back({"winner_changes", changes_});
    return counters;
  }

 private:
  // Rates relative to each other, which do not change with time.
  double share(std::uint32_t channel) const { return sum_.value(channel, 1.0); }

  void add(TimeNs time, std::span<const Spike> spikes) {
    sum_.prepare(moments_.latest());
    const double factor = sum_.factor(time);
    for (const Spike& spike : spikes) {
      sum_.add(static_cast<std::size_t>(spike.channel), factor);
    }
    // Only a channel that has just spiked can have come to the lead. Channels come in order.
    auto best = static_cast<std::uint32_t>(spikes.front().channel);
    for (const Spike& spike : spikes) {
      const auto channel = static_cast<std::uint32_t>(spike.channel);
      best = share(channel) > share(best) ? channel : best;
    }
    if (share(best) > (winner_ ? share(*winner_) * lead_ : 0.0) && best != winner_) {
      changes_ += winner_ ? 1 : 0;
      winner_ = best;
    }
  }

  // A new revision only when a value differs from the one before.
  void write(const SignalOutput& output, TimeNs end) {
    std::ranges::fill(values_, 0.0);
    switch (output_) {
      case Output::one_hot:
        values_[*winner_] = 1;
        break;
      case Output::index:
        values_[0] = *winner_;
        break;
      case Output::rate:
        values_[*winner_] = sum_.value(*winner_, sum_.decay(end)) / tau_;
        break;
    }
    if (output.revision() == 0 || !std::ranges::equal(values_, output.values())) {
      std::ranges::copy(values_, output.values().begin());
      output.commit();
    }
  }

  Output output_;
  double tau_;   // s
  double lead_;  // of a new winner, as a factor
  KernelSum sum_;
  SpikeMoments moments_;
  std::optional<std::uint32_t> winner_;
  std::vector<double> values_;
  std::uint64_t changes_ = 0;
};

}  // namespace

/// The rates are filtered with an exponential kernel. A channel wins when its rate exceeds the
/// winner's by the fraction `margin`; of several that do so at one moment the one with the highest
/// rate, of equal ones the lowest channel. All rates decay alike, so that the winner changes at
/// spikes alone, whatever the tick. There is none, and `out` is invalid, before the first spike; a
/// late spike can change the winner from its arrival on.
/// output = one_hot: 1 for the winner, else 0; index: its number, counted from 0, in one channel;
/// rate: its rate in Hz at the interval's end in its channel, else 0.
NodeClass winner_take_all_class() {
  NodeDescription description;
  description.name = "winner_take_all";
  description.text = "Selects the neuron with the highest filtered rate";
  description.source = "Maass 2000, On the computational power of winner-take-all";
  description.ports = {{"in", PortKind::spikes, Direction::input, {}, "One neuron per channel"},
                       {"out",
                        PortKind::signal,
                        Direction::output,
                        {},
                        "As wide as the input; with output=index, one channel"}};
  description.parameters = {
      kernel_tau_parameter(),
      number_parameter(
          "margin", "1", "0", 0, 1e9,
          "Fraction by which another neuron's rate must exceed the winner's rate to replace it"),
      {.name = "output",
       .type = ParameterType::choice,
       .default_value = "one_hot",
       .choices = {"one_hot", "index", "rate"},
       .text = "one_hot: 1 in the winner's channel; index: the winner's index; rate: the winner's "
               "rate in Hz, in its channel"}};
  return {description,
          [](const NodeSetup& setup) { return std::make_unique<WinnerTakeAll>(setup); }};
}

}  // namespace spikeloop
