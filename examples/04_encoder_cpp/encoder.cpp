// A rate encoder of one's own: regular spikes, 0 Hz at the input value -1 and rate_max at 1.
#include <algorithm>
#include <cmath>
#include <spikeloop/core/plugin.hpp>

using namespace spikeloop;

class MyRateEncoder : public Node {
 public:
  static NodeDescription describe() {
    return {.name = "my_rate_encoder",
            .text = "Regular spikes at a rate that follows the input",
            .ports = {{.name = "in", .text = "Values in [-1, 1]"},
                      {.name = "out",
                       .kind = PortKind::spikes,
                       .direction = Direction::output,
                       .width = WidthRule::same_as(0),
                       .text = "One neuron a channel"}},
            .parameters = {{.name = "rate_max",
                            .unit = "Hz",
                            .default_value = "100",
                            .minimum = 0,
                            .maximum = 1e6,
                            .text = "Rate at the input value 1"}}};
  }

  explicit MyRateEncoder(const NodeSetup& setup)
      : rate_max_(setup.parameters.number("rate_max")), left_(setup.widths[0], 1.0) {}

  void step(const Step& step) override {
    const SignalInput in = step.signal_input();
    const Interval now = step.interval();
    const auto length = static_cast<double>(now.length());
    for (std::size_t c = 0; in.valid() && c < left_.size(); ++c) {
      const double rate = rate_max_ * (std::clamp(in.values[c], -1.0, 1.0) + 1) / 2 * 1e-9;  // 1/ns
      if (!(rate > 0)) {
        continue;  // also for NaN
      }
      double wait = left_[c] / rate;  // ns from the interval's begin to the next spike
      for (; std::round(wait) <= length; wait += 1 / rate) {
        step.spike_output().emit(now.begin + std::max(1L, std::lround(wait)), static_cast<int>(c));
      }
      left_[c] = (wait - length) * rate;
    }
  }

 private:
  double rate_max_;           // Hz
  std::vector<double> left_;  // part of the interspike interval that is left, a channel
};

SPIKELOOP_PLUGIN(MyRateEncoder)
