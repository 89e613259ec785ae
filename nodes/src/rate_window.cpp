// `rate_window`: spikes counted in a sliding window (Dayan & Abbott 2001, sec. 1.2).
#include <algorithm>
#include <deque>
#include <memory>
#include <vector>

#include "parameter_checks.hpp"
#include "spike_moments.hpp"
#include "spikeloop/core/node.hpp"

namespace spikeloop {

namespace {

class RateWindow final : public Node {
 public:
  explicit RateWindow(const NodeSetup& setup)
      : seconds_(setup.parameters.number("window")),
        window_(from_seconds(seconds_)),
        counts_(setup.widths[0], 0) {}

  void step(const Step& step) override {
    const TimeNs outside = step.interval().end - window_;
    moments_.take(step.spike_input(), step.interval(),
                  [&](TimeNs time, std::span<const Spike> spikes) {
                    if (time > outside) {
                      add(time, spikes);
                    }
                  });
    while (!spikes_.empty() && spikes_.front().time_ns <= outside) {
      --counts_[static_cast<std::size_t>(spikes_.front().channel)];
      spikes_.pop_front();
    }
    write(step.signal_output());
  }

  std::vector<Counter> counters() const override { return moments_.counters(); }

 private:
  // At its place in the order of time: the end, unless the spikes are late.
  void add(TimeNs time, std::span<const Spike> spikes) {
    auto place = spikes_.end();
    if (!spikes_.empty() && spikes_.back().time_ns > time) {
      place = std::upper_bound(
          spikes_.begin(), spikes_.end(), time,
          [](TimeNs wanted, const Spike& spike) { return wanted < spike.time_ns; });
    }
    spikes_.insert(place, spikes.begin(), spikes.end());
    for (const Spike& spike : spikes) {
      ++counts_[static_cast<std::size_t>(spike.channel)];
    }
  }

  // A new revision only when a value differs from the one before, and at the first step.
  void write(const SignalOutput& output) {
    const std::span<double> values = output.values();
    bool changed = output.revision() == 0;
    for (std::size_t i = 0; i < values.size(); ++i) {
      const double value = static_cast<double>(counts_[i]) / seconds_;
      changed |= value != values[i];
      values[i] = value;
    }
    if (changed) {
      output.commit();
    }
  }

  double seconds_;
  TimeNs window_;
  SpikeMoments moments_;
  std::deque<Spike> spikes_;  // of the window, in the order of time
  std::vector<std::uint64_t> counts_;
};

}  // namespace

/// out[i](t) = number of spikes of channel i in (t - window, t] / window, in Hz, evaluated at the
/// interval's end. The counts are exact. A late spike counts as long as its true time is in the
/// window. Memory grows with the spikes of a window, never with the run.
NodeClass rate_window_class() {
  NodeDescription description;
  description.name = "rate_window";
  description.text = "Firing rate of each neuron: spike count in a sliding window";
  description.source = "Dayan & Abbott 2001, sec. 1.2";
  description.ports = {{"in", PortKind::spikes, Direction::input, {}, "One neuron per channel"},
                       {"out", PortKind::signal, Direction::output, WidthRule::same_as(0),
                        "Firing rate of the neuron, in Hz"}};
  description.parameters = {
      number_parameter("window", "s", "0.1", 1e-6, 1e6, "Length of the window")};
  return {description, [](const NodeSetup& setup) { return std::make_unique<RateWindow>(setup); }};
}

}  // namespace spikeloop
