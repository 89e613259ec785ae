// `temporal_contrast_encoder`: a spike for every large difference between successive values (Petro,
// Kasabov & Kiss 2020, threshold-based representation).
#include <algorithm>
#include <memory>
#include <vector>

#include "held_input.hpp"
#include "paired_channels.hpp"
#include "parameter_checks.hpp"
#include "spikeloop/core/node.hpp"

namespace spikeloop {

namespace {

class TemporalContrastEncoder final : public Node {
 public:
  explicit TemporalContrastEncoder(const NodeSetup& setup)
      : input_(setup), threshold_(setup.parameters.number("threshold")) {
    require_paired_channels(setup);
  }

  void step(const Step& step) override {
    const Interval interval = step.interval();
    const TimeNs stamp = interval.begin + kReaction;
    input_.update(step, [&](std::size_t c, double before) {
      const double difference = input_[c] - before;  // NaN when there is one value alone
      if (difference > threshold_ || difference < -threshold_) {
        due_.push_back(make_spike(stamp, paired_channel(c, difference > 0)));
      }
    });
    if (due_.empty() || due_.front().time_ns > interval.end) {
      return;
    }
    // In order of time: stamps follow the changes. Ticks can be shorter than the reaction.
    const auto later = std::ranges::find_if(
        due_, [&](const Spike& spike) { return spike.time_ns > interval.end; });
    step.spike_output().emit({due_.begin(), later});
    spikes_ += static_cast<std::uint64_t>(later - due_.begin());
    due_.erase(due_.begin(), later);
  }

  std::vector<Counter> counters() const override {
    std::vector<Counter> counters = {{"spikes", spikes_}};
    input_.append_counters(counters);
    return counters;
  }

 private:
  HeldInput input_;
  double threshold_;
  std::vector<Spike> due_;
  std::uint64_t spikes_ = 0;
};

}  // namespace

/// When input d changes by more than `threshold` from one value to the next, the output's channel
/// 2d spikes, when it falls by more, channel 2d+1, both 1 us after the change. There is no memory
/// but the value before: small changes never add up (those of `step_forward_encoder` do). The first
/// value, and the first after the input was invalid, has none to be compared with.
NodeClass temporal_contrast_encoder_class() {
  NodeDescription description;
  description.name = "temporal_contrast_encoder";
  description.text = "One spike per large difference between successive values";
  description.source = "Petro, Kasabov & Kiss 2020, threshold-based representation";
  description.ports = paired_channel_ports();
  description.parameters = {number_parameter("threshold", "1", "0.1", 0, 1e9,
                                             "Absolute difference above which a spike is emitted")};
  append_finite_input_policy(description.parameters);
  return {description,
          [](const NodeSetup& setup) { return std::make_unique<TemporalContrastEncoder>(setup); }};
}

}  // namespace spikeloop
