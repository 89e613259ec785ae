// `rate_encoder`: regular spikes at a rate that follows the input (Weidel et al. 2016, eq. 1).
#include "encoder_input.hpp"
#include "spike_thresholds.hpp"
#include "spikeloop/core/node.hpp"
#include "spikeloop/core/random.hpp"

namespace spikeloop {

namespace {

class RateEncoder final : public Node {
 public:
  explicit RateEncoder(const NodeSetup& setup)
      : input_(setup),
        schedule_(setup.share, setup.widths[0]),
        thresholds_(setup, false, schedule_) {
    if (setup.parameters.text("initial_phase") == "random") {
      const RandomStream stream(setup.seed, setup.name);
      for (std::uint32_t c = 0; c < schedule_.channels(); ++c) {
        schedule_.set_first_threshold(c, stream.uniform(schedule_.first() + c, 0));
      }
    }
  }

  void step(const Step& step) override {
    input_.update(step, schedule_);
    spikes_ += schedule_.advance(step.interval(), thresholds_, step.spike_output());
  }

  void change(std::string_view parameter, double value) override {
    input_.change(parameter, value);
  }

  std::vector<Counter> counters() const override {
    std::vector<Counter> counters = {{"spikes", spikes_}};
    input_.append_counters(counters);
    return counters;
  }

 private:
  EncoderInput input_;
  SpikeSchedule schedule_;
  SpikeThresholds thresholds_;
  std::uint64_t spikes_ = 0;
};

}  // namespace

/// Each channel integrates its rate and spikes whenever the integral passes a whole number: the
/// number of spikes equals the integral of the rate, to within one, whatever the input does.
NodeClass rate_encoder_class() {
  NodeDescription description;
  description.name = "rate_encoder";
  description.text = "Encodes each value as regular spikes with a rate that is linear in the value";
  description.source = "Weidel et al. 2016, eq. 1";
  description.ports = encoder_ports();
  description.parameters = encoder_parameters();
  description.shareable = true;
  description.parameters.push_back(
      {.name = "initial_phase",
       .type = ParameterType::choice,
       .default_value = "zero",
       .choices = {"zero", "random"},
       .text = "Fraction of the first interspike interval that has elapsed at the start"});
  return {description, [](const NodeSetup& setup) { return std::make_unique<RateEncoder>(setup); }};
}

}  // namespace spikeloop
