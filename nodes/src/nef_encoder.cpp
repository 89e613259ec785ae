// `nef_encoder`: a population of integrate-and-fire neurons that encodes a vector (Eliasmith &
// Anderson 2003, Neural Engineering, ch. 4).
#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "encoder_input.hpp"
#include "input_policy.hpp"
#include "nef_parameters.hpp"
#include "nef_population.hpp"
#include "spikeloop/core/node.hpp"

namespace spikeloop {

namespace {

constexpr double kMostInput = 1e100;

class NefEncoder final : public Node {
 public:
  explicit NefEncoder(const NodeSetup& setup)
      : policy_(setup),
        initial_(initial_of_encoder(setup.parameters, policy_.passes())),
        share_(setup.share),
        first_(share_.begin(setup.widths[1])),
        population_(nef_model(setup.parameters), share_.count(setup.widths[1]), setup.widths[0]),
        x_(setup.widths[0], 0.0) {
    draw_nef_neurons(setup, first_, share_.count(setup.widths[1]), setup.widths[0], population_);
  }

  void step(const Step& step) override {
    update(step);
    population_.advance(step.interval().end, first_, emitted_);
    step.spike_output().emit(emitted_);
    spikes_ += emitted_.size();
    emitted_.clear();
  }

  std::vector<Counter> counters() const override {
    std::vector<Counter> counters = {{"spikes", spikes_}};
    policy_.append_counters(counters);
    if (share_.index != 0) {  // all shares see all inputs
      std::for_each(counters.begin() + 1, counters.end(), [](Counter& one) { one.value = 0; });
    }
    return counters;
  }

 private:
  // Without a value, the neurons rest; their potentials stay.
  void update(const Step& step) {
    const SignalInput input = step.signal_input();
    const TimeNs now = step.interval().begin;
    if (input.valid()) {
      // Equal values must not begin a new segment: rounding would depend on revisions.
      if (input.revision != revision_ && (take(input.values) || !has_input_)) {
        population_.set_input(now, x_);
        has_input_ = true;
      }
    } else if (!begun_ && initial_) {
      std::ranges::fill(x_, *initial_);
      population_.set_input(now, x_);
      has_input_ = true;
    } else if (revision_ != 0) {
      population_.rest(now);
      has_input_ = false;
    }
    begun_ = true;
    revision_ = input.revision;
  }

  // Whether a value is another one.
  bool take(std::span<const double> values) {
    bool changed = false;
    for (std::size_t k = 0; k < x_.size(); ++k) {
      // So that no sum of products overflows; NaN stays.
      const double value = std::clamp(policy_.treat(values[k], k), -kMostInput, kMostInput);
      if (!std::isnan(value) && value != x_[k]) {
        x_[k] = value;
        changed = true;
      }
    }
    return changed;
  }

  InputPolicy policy_;
  std::optional<double> initial_;
  Share share_;
  std::uint32_t first_;
  NefPopulation population_;
  std::vector<double> x_;  // each channel's last good value
  bool begun_ = false;
  bool has_input_ = false;
  std::uint64_t revision_ = 0;
  std::uint64_t spikes_ = 0;
  std::vector<Spike> emitted_;
};

}  // namespace

/// Neuron n gets the current  bias_n + gain_n (e_n . x)  of the whole input vector x, where e_n is
/// a unit vector, and is a leaky integrate-and-fire neuron:
///     tau_m dV/dt = -V + R I;  at the threshold: a spike, and V = 0 for t_ref.
/// The time at which V meets the threshold is solved for, not stepped to: at a constant input
/// T = tau_m ln(R I / (R I - v_th)) after V was 0. With `spike_times=interpolated` the interval
/// between spikes is t_ref + T; on a grid of step h, t_ref + ceil(T / h) h. As Nengo's, neurons of
/// `preset=nengo` never have a potential below 0: they answer at once when their input comes back.
NodeClass nef_encoder_class() {
  NodeDescription description;
  description.name = "nef_encoder";
  description.text = "Encodes a vector in the spikes of a population of neurons";
  description.source = "Weidel et al. 2016, eq. 3 and 4; Eliasmith & Anderson 2003, ch. 4";
  description.ports = {
      {"in", PortKind::signal, Direction::input, {}, "Values in [-1, 1], one per dimension"},
      {"out", PortKind::spikes, Direction::output, {}, "One neuron per channel"}};
  description.parameters = nef_parameters();
  description.shareable = true;
  return {description, [](const NodeSetup& setup) { return std::make_unique<NefEncoder>(setup); }};
}

}  // namespace spikeloop
