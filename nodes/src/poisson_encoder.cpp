// `poisson_encoder`: Poisson spikes at a rate that follows the input (Weidel et al. 2016, eq. 2).
#include "encoder_input.hpp"
#include "spike_thresholds.hpp"
#include "spikeloop/core/node.hpp"

namespace spikeloop {

namespace {

class PoissonEncoder final : public Node {
 public:
  explicit PoissonEncoder(const NodeSetup& setup)
      : input_(setup),
        schedule_(setup.share, setup.widths[0]),
        thresholds_(setup, true, schedule_) {}

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

/// Each channel is an inhomogeneous Poisson process, exact for a changing rate: the integral of the
/// rate between two spikes is exponentially distributed with mean 1. Draw d of a channel's random
/// stream decides its spike d, so channels are independent and no spike depends on ticks.
NodeClass poisson_encoder_class() {
  NodeDescription description;
  description.name = "poisson_encoder";
  description.text = "Encodes each value as Poisson spikes with a rate that is linear in the value";
  description.source = "Weidel et al. 2016, eq. 2";
  description.ports = encoder_ports();
  description.parameters = encoder_parameters();
  description.shareable = true;
  return {description,
          [](const NodeSetup& setup) { return std::make_unique<PoissonEncoder>(setup); }};
}

}  // namespace spikeloop
