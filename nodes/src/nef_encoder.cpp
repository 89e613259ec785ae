#include "nef_encoder.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <vector>

#include "encoder_input.hpp"
#include "input_policy.hpp"
#include "lif_neuron.hpp"
#include "spikeloop/core/random.hpp"

namespace spikeloop {

namespace {

// Places of a neuron's random numbers in its stream; the direction's follow.
enum Draw : std::uint64_t { kPotential, kGain, kBias, kAxis, kDirection };

double between(double low, double high, double part) {
  return low + part * (high - low);
}

// Equally likely in every direction: a vector of normal numbers (Box & Muller 1958), made a unit.
void draw_direction(const RandomStream& stream, std::uint64_t neuron, std::span<double> direction) {
  double squares = 0;
  for (std::size_t d = 0; d < direction.size(); ++d) {
    const double radius = std::sqrt(-2 * std::log(stream.uniform(neuron, kDirection + 2 * d)));
    const double angle = 2 * std::numbers::pi * stream.uniform(neuron, kDirection + 2 * d + 1);
    direction[d] = radius * std::cos(angle);
    squares += direction[d] * direction[d];
  }
  for (double& component : direction) {
    component /= std::sqrt(squares);
  }
}

void draw_axis(const RandomStream& stream, std::uint64_t neuron, std::span<double> direction) {
  const auto axis = static_cast<std::size_t>(stream.bits(neuron, kAxis) % direction.size());
  std::ranges::fill(direction, 0.0);
  direction[axis] = 1.0;
}

void check_order(const Parameters& given, const char* low, const char* high) {
  if (given.number(low) > given.number(high)) {
    throw ConfigurationError(given.where(low),
                             fmt::format("key '{0}': {1} is above {2}, {3}; write {0} at most {2}",
                                         low, given.number(low), high, given.number(high)));
  }
}

LifModel model_of(const Parameters& given) {
  return {.tau_ns = given.number("tau_m") * 1e9,
          .resistance = given.number("tau_m") / given.number("c_m") * 1e3,
          .threshold = given.number("v_th"),
          .refractory = from_seconds(given.number("t_ref"))};
}

class NefEncoder final : public Node {
 public:
  explicit NefEncoder(const NodeSetup& setup)
      : policy_(setup),
        initial_(initial_of_encoder(setup.parameters, policy_.passes())),
        dimensions_(setup.widths[0]),
        model_(model_of(setup.parameters)),
        x_(dimensions_, 0.0) {
    check_order(setup.parameters, "gain_min", "gain_max");
    check_order(setup.parameters, "bias_min", "bias_max");
    draw(setup);
  }

  void step(const Step& step) override {
    update(step);
    const TimeNs end = step.interval().end;
    if (earliest_ > end) {
      return;
    }
    earliest_ = LifNeuron::kNever;
    for (std::size_t n = 0; n < neurons_.size(); ++n) {
      while (neurons_[n].next() <= end) {
        emitted_.push_back(make_spike(neurons_[n].next(), static_cast<std::int32_t>(n)));
        neurons_[n].fire(model_);
      }
      earliest_ = std::min(earliest_, neurons_[n].next());
    }
    step.spike_output().emit(emitted_);
    spikes_ += emitted_.size();
    emitted_.clear();
  }

  std::vector<Counter> counters() const override {
    std::vector<Counter> counters = {{"spikes", spikes_}};
    policy_.append_counters(counters);
    return counters;
  }

 private:
  void draw(const NodeSetup& setup) {
    const Parameters& given = setup.parameters;
    const std::uint32_t count = setup.widths[1];
    const RandomStream stream(setup.seed, setup.name);
    directions_.resize(std::size_t{count} * dimensions_);
    for (std::uint32_t n = 0; n < count; ++n) {
      const std::span<double> direction(&directions_[std::size_t{n} * dimensions_], dimensions_);
      given.boolean("one_hot") ? draw_axis(stream, n, direction)
                               : draw_direction(stream, n, direction);
      const auto drawn = [&](const char* low, const char* high, Draw what) {
        return between(given.number(low), given.number(high), stream.uniform(n, what));
      };
      gain_.push_back(drawn("gain_min", "gain_max", kGain));
      bias_.push_back(drawn("bias_min", "bias_max", kBias));
      // Below the threshold: uniform() is in (0, 1].
      neurons_.emplace_back(model_.threshold * (1 - stream.uniform(n, kPotential)));
    }
  }

  // Without a value, the neurons rest; their potentials stay.
  void update(const Step& step) {
    const SignalInput input = step.signal_input();
    const TimeNs now = step.interval().begin;
    if (input.valid()) {
      if (input.revision != revision_) {
        take(input.values);
        set_currents(now);
      }
    } else if (!begun_ && initial_) {
      std::ranges::fill(x_, *initial_);
      set_currents(now);
    } else if (revision_ != 0) {
      for (LifNeuron& neuron : neurons_) {
        neuron.rest(now, model_);
      }
      earliest_ = LifNeuron::kNever;
    }
    begun_ = true;
    revision_ = input.revision;
  }

  void take(std::span<const double> values) {
    for (std::size_t d = 0; d < x_.size(); ++d) {
      const double value = policy_.treat(values[d], d);
      x_[d] = std::isnan(value) ? x_[d] : value;
    }
  }

  void set_currents(TimeNs now) {
    earliest_ = LifNeuron::kNever;
    const double* component = directions_.data();
    for (std::size_t n = 0; n < neurons_.size(); ++n) {
      double along = 0;
      for (const double x : x_) {
        along += *component++ * x;
      }
      neurons_[n].set_current(now, bias_[n] + gain_[n] * along, model_);
      earliest_ = std::min(earliest_, neurons_[n].next());
    }
  }

  InputPolicy policy_;
  std::optional<double> initial_;
  std::size_t dimensions_;
  LifModel model_;
  std::vector<double> x_;           // each channel's last good value
  std::vector<double> directions_;  // neuron by neuron
  std::vector<double> gain_;        // pA
  std::vector<double> bias_;        // pA
  std::vector<LifNeuron> neurons_;
  TimeNs earliest_ = LifNeuron::kNever;
  bool begun_ = false;
  std::uint64_t revision_ = 0;
  std::uint64_t spikes_ = 0;
  std::vector<Spike> emitted_;
};

ParameterDescription number(std::string name, std::string unit, std::string value, double minimum,
                            double maximum, std::string text) {
  return {.name = std::move(name),
          .unit = std::move(unit),
          .default_value = std::move(value),
          .minimum = minimum,
          .maximum = maximum,
          .text = std::move(text)};
}

std::vector<ParameterDescription> parameters_of_nef() {
  constexpr double kMost = 1e9;
  std::vector<ParameterDescription> parameters = {
      number("tau_m", "s", "0.02", 1e-6, 1e3, "Time constant of the membrane"),
      number("c_m", "pF", "250", 1e-6, kMost, "Capacitance of the membrane"),
      number("v_th", "mV", "10", 1e-6, kMost, "Threshold, above the resting and reset potential"),
      number("t_ref", "s", "0.002", 0, 1e3, "Refractory period"),
      number("gain_min", "pA", "0", -kMost, kMost, "Gains are drawn between this"),
      number("gain_max", "pA", "300", -kMost, kMost, "and this"),
      number("bias_min", "pA", "0", -kMost, kMost, "Constant currents are drawn between this"),
      number("bias_max", "pA", "200", -kMost, kMost, "and this"),
      {.name = "one_hot",
       .type = ParameterType::boolean,
       .default_value = "false",
       .text = "Each neuron encodes one channel alone"},
      initial_of_encoder_parameter()};
  append_encoder_input_policy(parameters);
  return parameters;
}

}  // namespace

NodeClass nef_encoder_class() {
  NodeDescription description;
  description.name = "nef_encoder";
  description.text = "Encodes a vector in the spikes of a population of neurons";
  description.source = "Eliasmith & Anderson 2003, ch. 4";
  description.ports = {
      {"in", PortKind::signal, Direction::input, {}, "Values in [-1, 1], one a dimension"},
      {"out", PortKind::spikes, Direction::output, {}, "One neuron a channel"}};
  description.parameters = parameters_of_nef();
  return {description, [](const NodeSetup& setup) { return std::make_unique<NefEncoder>(setup); }};
}

}  // namespace spikeloop
