#include "poisson_encoder.hpp"

#include "encoder_input.hpp"
#include "spikeloop/core/random.hpp"

namespace spikeloop {

namespace {

class PoissonEncoder final : public Node {
 public:
  explicit PoissonEncoder(const NodeSetup& setup)
      : input_(setup),
        schedule_(setup.widths[0]),
        stream_(setup.seed, setup.name),
        draws_(setup.widths[0], 0) {
    for (std::uint32_t c = 0; c < schedule_.channels(); ++c) {
      schedule_.set_first_threshold(c, draw(c));
    }
  }

  void step(const Step& step) override {
    input_.update(step, schedule_);
    spikes_ += schedule_.advance(
        step.interval(), [this](std::uint32_t c) { return draw(c); }, step.spike_output());
  }

  std::vector<Counter> counters() const override {
    std::vector<Counter> counters = {{"spikes", spikes_}};
    input_.append_counters(counters);
    return counters;
  }

 private:
  double draw(std::uint32_t channel) { return stream_.exponential(channel, draws_[channel]++); }

  EncoderInput input_;
  SpikeSchedule schedule_;
  RandomStream stream_;
  std::vector<std::uint64_t> draws_;  // index of each channel's next draw
  std::uint64_t spikes_ = 0;
};

}  // namespace

NodeClass poisson_encoder_class() {
  NodeDescription description;
  description.name = "poisson_encoder";
  description.text = "Turns each value into Poisson spikes at a proportional rate";
  description.source = "Weidel et al. 2016, eq. 2";
  description.ports = encoder_ports();
  description.parameters = encoder_parameters();
  return {description,
          [](const NodeSetup& setup) { return std::make_unique<PoissonEncoder>(setup); }};
}

}  // namespace spikeloop
