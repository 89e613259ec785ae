#include "poisson_encoder.hpp"

#include <span>

#include "encoder_input.hpp"
#include "large_array.hpp"
#include "spikeloop/core/random.hpp"

namespace spikeloop {

namespace {

class PoissonEncoder final : public Node {
 public:
  explicit PoissonEncoder(const NodeSetup& setup)
      : input_(setup),
        schedule_(setup.share, setup.widths[0]),
        stream_(setup.seed, setup.name),
        draws_(schedule_.channels(), 0) {
    for (std::uint32_t c = 0; c < schedule_.channels(); ++c) {
      double threshold = 0;
      draw({&c, 1}, {&threshold, 1});
      schedule_.set_first_threshold(c, threshold);
    }
  }

  void step(const Step& step) override {
    input_.update(step, schedule_);
    spikes_ += schedule_.advance(
        step.interval(),
        [this](std::span<const std::uint32_t> channels, std::span<double> next) {
          draw(channels, next);
        },
        step.spike_output());
  }

  std::vector<Counter> counters() const override {
    std::vector<Counter> counters = {{"spikes", spikes_}};
    input_.append_counters(counters);
    return counters;
  }

 private:
  /// Each channel's next exponentially distributed number, of mean 1. Channels count from the
  /// share's first one.
  void draw(std::span<const std::uint32_t> channels, std::span<double> next) {
    indices_.resize(channels.size());
    for (std::size_t i = 0; i < channels.size(); ++i) {
      indices_[i] = draws_[channels[i]]++;
    }
    stream_.uniform(schedule_.first(), channels, indices_, next);
    negative_logarithms(next);
  }

  EncoderInput input_;
  SpikeSchedule schedule_;
  RandomStream stream_;
  LargeArray<std::uint64_t> draws_;  // index of each channel's next draw
  std::vector<std::uint64_t> indices_;
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
  description.shareable = true;
  return {description,
          [](const NodeSetup& setup) { return std::make_unique<PoissonEncoder>(setup); }};
}

}  // namespace spikeloop
