// `population_encoder`: each value in the rates of neurons with Gaussian receptive fields (Bohte,
// La Poutre & Kok 2002).
#include <fmt/format.h>

#include <cmath>
#include <memory>
#include <optional>
#include <vector>

#include "held_input.hpp"
#include "parameter_checks.hpp"
#include "preferred_values.hpp"
#include "spike_schedule.hpp"
#include "spike_thresholds.hpp"
#include "spikeloop/core/code.hpp"
#include "spikeloop/core/node.hpp"
#include "spikeloop/core/random.hpp"

namespace spikeloop {

namespace {

constexpr double kBeta = 1.5;  // Bohte et al. 2002, sec. III

double width_of_fields(const Parameters& given, const ValueRange& range, std::uint32_t neurons) {
  const std::optional<double> written =
      number_or_word(given, "sigma", "auto", "write a number above 0, or auto");
  if (!written) {
    return spacing(range, neurons) / kBeta;
  }
  // The square of less would be 0.
  if (*written < 1e-9) {
    throw ConfigurationError(
        given.where("sigma"),
        with_code(Code::out_of_bounds,
                  "key 'sigma': {} is out of bounds; write a number of at least 1e-09, or auto",
                  *written));
  }
  return *written;
}

// The fields of the neurons that encode one value.
class ReceptiveFields {
 public:
  ReceptiveFields(const Parameters& given, std::uint32_t neurons)
      : range_(value_range(given)),
        preferred_(preferred_values(range_, neurons)),
        sigma_(width_of_fields(given, range_, neurons)) {}

  // 1 at the preferred value of neuron i, towards 0 away from it.
  double response(std::size_t i, double x) const {
    double away = x - preferred_[i];
    if (range_.circular) {
      away = std::remainder(away, range_.length());
    }
    away /= sigma_;
    return std::exp(-away * away / 2);
  }

 private:
  ValueRange range_;
  std::vector<double> preferred_;
  double sigma_;
};

class PopulationEncoder final : public Node {
 public:
  explicit PopulationEncoder(const NodeSetup& setup)
      : input_(setup, number_or_word(setup.parameters, "initial", "none",
                                     "write a value, or none for silence until the first input")),
        neurons_(neurons_a_value(setup, 1, 0)),
        fields_(setup.parameters, neurons_),
        rate_min_(setup.parameters.number("rate_min")),
        rate_span_(setup.parameters.number("rate_max") - rate_min_),
        schedule_(setup.widths[1]),
        thresholds_(setup, setup.parameters.text("spikes") == "poisson", schedule_) {}

  void step(const Step& step) override {
    bool changed = false;
    input_.update(step, [&](std::size_t, double) { changed = true; });
    if (changed) {
      schedule_.set_rates(step.interval().begin, [this](std::uint32_t i) { return rate_of(i); });
    }
    spikes_ += schedule_.advance(step.interval(), thresholds_, step.spike_output());
  }

  std::vector<Counter> counters() const override {
    std::vector<Counter> counters = {{"spikes", spikes_}};
    input_.append_counters(counters);
    return counters;
  }

 private:
  double rate_of(std::uint32_t neuron) const {
    const double x = input_[neuron / neurons_];
    return std::isnan(x) ? 0.0 : rate_min_ + rate_span_ * fields_.response(neuron % neurons_, x);
  }

  HeldInput input_;
  std::uint32_t neurons_;  // for each value
  ReceptiveFields fields_;
  double rate_min_;   // Hz
  double rate_span_;  // Hz
  SpikeSchedule schedule_;
  SpikeThresholds thresholds_;
  std::uint64_t spikes_ = 0;
};

std::vector<ParameterDescription> parameters_of_population() {
  constexpr double kMost = SpikeSchedule::kFastest;
  std::vector<ParameterDescription> parameters = {
      number_parameter("rate_min", "Hz", "0", 0, kMost, "Firing rate far from the preferred value"),
      number_parameter("rate_max", "Hz", "100", 0, kMost, "Firing rate at the preferred value")};
  append_value_range(parameters);
  parameters.push_back(number_or_word_parameter(
      "sigma", "auto",
      "Width of the receptive fields; auto: the spacing of the preferred values / 1.5"));
  parameters.push_back({.name = "spikes",
                        .type = ParameterType::choice,
                        .default_value = "regular",
                        .choices = {"regular", "poisson"},
                        .text = "Regular spikes, or a Poisson process"});
  parameters.push_back(number_or_word_parameter(
      "initial", "none", "Input value before the first one arrives; none: no spikes"));
  append_finite_input_policy(parameters);
  return parameters;
}

}  // namespace

/// Channel d is encoded by the neurons d*n to d*n + n-1, where n is the width of `out` divided by
/// that of `in`. Their preferred values mu are evenly spaced from value_min to value_max, and
///     rate = rate_min + (rate_max - rate_min) exp(-(x - mu)^2 / (2 sigma^2)).
/// `sigma = auto` is the spacing divided by beta = 1.5: the rule of Bohte et al., whose fields lie
/// (max - min) / (n - 2) apart, the outer two beyond the range; here the outer two lie on its ends.
/// It holds for every n, with the whole range as the spacing of one neuron. On a circle, x - mu is
/// the shorter way round. Values outside the range are not clipped: all fields are far from them.
/// Spikes are regular (of rate_encoder) or Poisson (of poisson_encoder), with their exactness.
NodeClass population_encoder_class() {
  NodeDescription description;
  description.name = "population_encoder";
  description.text = "Encodes each value in the rates of neurons with Gaussian receptive fields";
  description.source = "Bohte, La Poutre & Kok 2002, sec. III";
  description.ports = {
      {"in", PortKind::signal, Direction::input, {}, "Values between value_min and value_max"},
      {"out",
       PortKind::spikes,
       Direction::output,
       {},
       "A multiple of the input width: the neurons of the first value, then those of the second, "
       "..."}};
  description.parameters = parameters_of_population();
  return {description,
          [](const NodeSetup& setup) { return std::make_unique<PopulationEncoder>(setup); }};
}

}  // namespace spikeloop
