// `disturb_spikes`: lost spikes, jitter and silent neurons, to measure robustness.
#include <algorithm>
#include <cmath>
#include <memory>
#include <numeric>
#include <queue>
#include <vector>

#include "disturbance.hpp"
#include "parameter_checks.hpp"
#include "spikeloop/core/node.hpp"
#include "spikeloop/core/random.hpp"

namespace spikeloop {

namespace {

class DisturbSpikes final : public Node {
 public:
  explicit DisturbSpikes(const NodeSetup& setup)
      : period_(setup.parameters),
        random_(setup.noise_seed(), setup.name),
        drop_(setup.parameters.number("drop")),
        jitter_(setup.parameters.number("jitter") * 1e9),
        arrived_(setup.widths[0], 0),
        silent_(lesion(setup)) {}

  void step(const Step& step) override {
    const Interval interval = step.interval();
    for (Spike spike : step.spike_input().spikes) {
      spike.time_ns = std::max(spike.time_ns, interval.begin + 1);  // a late one leaves at once
      take(spike);
    }
    while (!pending_.empty() && pending_.top().time_ns <= interval.end) {
      step.spike_output().emit(pending_.top().time_ns, pending_.top().channel);
      pending_.pop();
      ++spikes_;
    }
  }

  void change(std::string_view parameter, double value) override {
    if (parameter == "drop") {
      drop_ = value;
    } else {
      jitter_ = value * 1e9;
    }
  }

  std::vector<Counter> counters() const override {
    return {{"spikes", spikes_}, {"dropped", dropped_}};
  }

 private:
  struct Later {
    bool operator()(const Spike& a, const Spike& b) const { return spike_before(b, a); }
  };

  /// The channels with the smallest random numbers.
  static std::vector<bool> lesion(const NodeSetup& setup) {
    const RandomStream random(setup.seed, setup.name, 1);
    const std::size_t width = setup.widths[0];
    std::vector<double> numbers(width);
    for (std::size_t c = 0; c < width; ++c) {
      numbers[c] = random.uniform(c, 0);
    }
    std::vector<std::size_t> order(width);
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::ranges::sort(order, {}, [&](std::size_t c) { return numbers[c]; });
    const double share = setup.parameters.number("lesion") * static_cast<double>(width);
    std::vector<bool> silent(width, false);
    for (std::size_t i = 0; i < static_cast<std::size_t>(std::llround(share)); ++i) {
      silent[order[i]] = true;
    }
    return silent;
  }

  /// Draws belong to the spike's number on its channel, whatever the tick.
  void take(Spike spike) {
    const auto channel = static_cast<std::size_t>(spike.channel);
    const std::uint64_t draw = 2 * arrived_[channel]++;
    if (period_.contains(spike.time_ns)) {
      if (silent_[channel] || (drop_ > 0 && random_.uniform(channel, draw) <= drop_)) {
        ++dropped_;
        return;
      }
      if (jitter_ > 0) {
        spike.time_ns += static_cast<TimeNs>(jitter_ * random_.uniform(channel, draw + 1));
      }
    }
    pending_.push(spike);
  }

  Disturbance period_;
  RandomStream random_;
  double drop_;
  double jitter_;  // ns
  std::vector<std::uint64_t> arrived_;
  std::vector<bool> silent_;
  std::priority_queue<Spike, std::vector<Spike>, Later> pending_;
  std::uint64_t spikes_ = 0;
  std::uint64_t dropped_ = 0;
};

}  // namespace

/// Spikes at times in (from, to] are changed, all others pass. round(lesion * width) channels,
/// chosen at random, are silent. Of the rest each spike is lost with the probability `drop`; else
/// it is delayed by a time that is uniform in (0, jitter]. Random numbers belong to the n-th spike
/// of a channel, so no spike depends on ticks.
NodeClass disturb_spikes_class() {
  NodeDescription description;
  description.name = "disturb_spikes";
  description.text = "Loses and delays spikes, and silences neurons";
  description.source =
      "a spike at s is lost with probability drop, or moves to s + jitter * U(0, 1)";
  description.ports = {
      {"in", PortKind::spikes, Direction::input, {}, "The spikes to disturb"},
      {"out", PortKind::spikes, Direction::output, WidthRule::same_as(0), "Those that are left"}};
  description.parameters = {
      changeable(number_parameter("drop", "1", "0", 0, 1, "Probability that a spike is lost")),
      changeable(number_parameter("jitter", "s", "0", 0, 10, "Largest random delay of a spike")),
      number_parameter("lesion", "1", "0", 0, 1,
                       "Fraction of the channels that are silent, rounded to whole ones")};
  append_disturbance_period(description.parameters);
  return {description,
          [](const NodeSetup& setup) { return std::make_unique<DisturbSpikes>(setup); }};
}

}  // namespace spikeloop
