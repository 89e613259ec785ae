#include "nef_parameters.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>

#include "encoder_input.hpp"
#include "parameter_checks.hpp"
#include "spikeloop/core/code.hpp"
#include "spikeloop/core/random.hpp"
#include "spikeloop/core/units.hpp"

namespace spikeloop {

namespace {

// Places of a neuron's random numbers in its stream; the direction's follow.
enum Draw : std::uint64_t { kPotential, kGain, kBias, kAxis, kDirection };

/// What a preset has instead of the declared defaults, which are those of rma.
struct PresetDefault {
  const char* preset;
  const char* key;
  double value;
};
constexpr PresetDefault kPresetDefaults[] = {
    {"ma", "tau_m", 0.01},   {"ma", "v_th", 15},      {"ma", "gain_min", 100},
    {"ma", "gain_max", 100}, {"ma", "bias_min", 275}, {"ma", "bias_max", 475},
};
constexpr const char* kOfNengo[] = {"max_rate_low", "max_rate_high", "intercept_low",
                                    "intercept_high", "radius"};
constexpr const char* kOfCurrents[] = {"c_m",      "v_th",     "gain_min",
                                       "gain_max", "bias_min", "bias_max"};

bool is_nengo(const Parameters& given) {
  return given.text("preset") == "nengo";
}

double number(const Parameters& given, const char* key) {
  const auto* const found = std::ranges::find_if(kPresetDefaults, [&](const PresetDefault& entry) {
    return given.text("preset") == entry.preset && std::string_view(key) == entry.key;
  });
  return given.given(key) || found == std::end(kPresetDefaults) ? given.number(key) : found->value;
}

void check_order(const Parameters& given, const char* low, const char* high) {
  if (number(given, low) > number(given, high)) {
    throw ConfigurationError(
        given.where(given.given(low) ? low : high),
        with_code(Code::wrong_order, "key '{0}': {1} is above {2}, {3}; write {0} at most {2}", low,
                  number(given, low), high, number(given, high)));
  }
}

void check_keys(const Parameters& given) {
  const bool nengo = is_nengo(given);
  const auto refuse = [&](const char* key) {
    if (given.given(key)) {
      throw ConfigurationError(
          given.where(key),
          nengo ? with_code(Code::conflicting_keys,
                            "key '{}' is of the presets rma and ma; write preset=rma, or "
                            "max_rate_low, max_rate_high, intercept_low and intercept_high",
                            key)
                : with_code(Code::conflicting_keys,
                            "key '{}' is of the preset nengo; write preset=nengo, or gain_min, "
                            "gain_max, bias_min and bias_max",
                            key));
    }
  };
  nengo ? std::ranges::for_each(kOfCurrents, refuse) : std::ranges::for_each(kOfNengo, refuse);
}

void check_rates(const Parameters& given) {
  constexpr double kLeast_s = 1e-6;  // from the refractory period to the spike
  constexpr double kMostTaus = 25;   // beyond, the membrane is within 1e-11 of its target
  const double highest = given.number("max_rate_high");
  const double lowest = given.number("max_rate_low");
  const double t_ref = given.number("t_ref");
  const double tau_m = given.number("tau_m");
  if ((1 / lowest - t_ref) / tau_m > kMostTaus) {
    throw ConfigurationError(
        given.where(given.given("max_rate_low") ? "max_rate_low" : "tau_m"),
        with_code(Code::out_of_bounds,
                  "key 'max_rate_low': {} Hz are too slow for a membrane of {} s; write at least "
                  "{} Hz, or a longer tau_m",
                  lowest, tau_m, format_rounded(1.01 / (t_ref + kMostTaus * tau_m), 3)));
  }
  if (!(1 / highest - t_ref >= kLeast_s)) {
    throw ConfigurationError(
        given.where(given.given("max_rate_high") ? "max_rate_high" : "t_ref"),
        with_code(Code::out_of_bounds,
                  "key 'max_rate_high': {} Hz leaves no time between refractory periods of {} s; "
                  "write less than {:g} Hz",
                  highest, t_ref, 1 / (t_ref + kLeast_s)));
  }
}

/// 0 for interpolated times.
TimeNs grid_of(const Parameters& given) {
  if (given.text("spike_times") == "interpolated") {
    return 0;
  }
  const TimeNs grid = from_seconds(given.number("resolution"));
  const TimeNs refractory = from_seconds(given.number("t_ref"));
  if (refractory % grid != 0) {
    throw ConfigurationError(
        given.where(given.given("t_ref") ? "t_ref" : "resolution"),
        with_code(Code::off_grid,
                  "key 't_ref': {} is not a multiple of the resolution, {}; write another one, or "
                  "spike_times=interpolated",
                  format_time(refractory), format_time(grid)));
  }
  return grid;
}

// Equally likely in every direction: a vector of normal numbers (Box & Muller 1958), made a unit.
void draw_direction(const RandomStream& stream, std::uint64_t neuron, std::span<double> direction) {
  double squares = 0;
  for (std::size_t k = 0; k < direction.size(); k += 2) {
    const double radius = std::sqrt(-2 * std::log(stream.uniform(neuron, kDirection + k)));
    const double angle = 2 * std::numbers::pi * stream.uniform(neuron, kDirection + k + 1);
    direction[k] = radius * std::cos(angle);
    squares += direction[k] * direction[k];
    if (k + 1 < direction.size()) {
      direction[k + 1] = radius * std::sin(angle);
      squares += direction[k + 1] * direction[k + 1];
    }
  }
  const double length = std::sqrt(squares);
  for (double& component : direction) {
    component /= length;
  }
}

void draw_axis(const RandomStream& stream, std::uint64_t neuron, std::span<double> direction) {
  const auto axis = static_cast<std::size_t>(stream.bits(neuron, kAxis) % direction.size());
  std::ranges::fill(direction, 0.0);
  direction[axis] = 1.0;
}

struct Tuning {
  double gain;
  double bias;
};

/// Draws gain and bias: of Nengo's convention in units of the threshold, else in pA. The bias is
/// counted from what holds a neuron at the threshold.
class TuningDraw {
 public:
  explicit TuningDraw(const Parameters& given)
      : nengo_(is_nengo(given)),
        t_ref_(given.number("t_ref")),
        tau_m_(number(given, "tau_m")),
        radius_(given.number("radius")),
        rheobase_(number(given, "v_th") / (tau_m_ / number(given, "c_m") * 1e3)),
        first_(bounds(given, "max_rate_low", "max_rate_high", "gain_min", "gain_max")),
        second_(bounds(given, "intercept_low", "intercept_high", "bias_min", "bias_max")) {}

  Tuning draw(const RandomStream& stream, std::uint64_t neuron) const {
    const double first = first_.at(stream.uniform(neuron, kGain));
    const double second = second_.at(stream.uniform(neuron, kBias));
    return nengo_ ? of_nengo(first, second) : Tuning{first, second - rheobase_};
  }

 private:
  struct Bounds {
    double low;
    double high;
    double at(double part) const { return low + part * (high - low); }
  };

  Bounds bounds(const Parameters& given, const char* low, const char* high, const char* older_low,
                const char* older_high) const {
    return {number(given, nengo_ ? low : older_low), number(given, nengo_ ? high : older_high)};
  }

  Tuning of_nengo(double max_rate, double intercept) const {
    // How far above the threshold the drive is with which the membrane takes so long to meet it.
    const double above = 1 / std::expm1((1 / max_rate - t_ref_) / tau_m_);
    const double gain = above / (1 - intercept);
    return {gain / radius_, -gain * intercept};
  }

  bool nengo_;
  double t_ref_;  // s
  double tau_m_;  // s
  double radius_;
  double rheobase_;  // pA, rma and ma
  Bounds first_;     // of rates in Hz, or gains
  Bounds second_;    // of intercepts, or biases
};

}  // namespace

std::vector<ParameterDescription> nef_parameters() {
  constexpr double kMost = 1e9;
  std::vector<ParameterDescription> parameters = {
      {.name = "preset",
       .type = ParameterType::choice,
       .default_value = "nengo",
       .choices = {"nengo", "rma", "ma"},
       .text =
           "Parameter set: that of Nengo, of ros_music_adapter (rma) or of music-adapters (ma)"},
      number_parameter("tau_m", "s", "0.02", 1e-6, 1e3, "Membrane time constant (ma: 0.01)"),
      number_parameter("t_ref", "s", "0.002", 0, 1e3, "Refractory period"),
      number_parameter("max_rate_low", "Hz", "200", 1e-3, 1e6,
                       "nengo: lower bound of the random firing rates at the radius"),
      number_parameter("max_rate_high", "Hz", "400", 1e-3, 1e6,
                       "nengo: upper bound of the random firing rates at the radius"),
      number_parameter(
          "intercept_low", "1", "-1", -1e3, 0.999,
          "nengo: lower bound of the random intercepts (inputs at which firing begins)"),
      number_parameter("intercept_high", "1", "0.9", -1e3, 0.999,
                       "nengo: upper bound of the random intercepts"),
      number_parameter("radius", "1", "1", 1e-9, kMost, "nengo: largest norm of the input vector"),
      number_parameter("c_m", "pF", "250", 1e-6, kMost, "rma, ma: membrane capacitance"),
      number_parameter("v_th", "mV", "10", 1e-6, kMost,
                       "rma, ma: threshold, relative to the resting and reset potential (ma: 15)"),
      number_parameter("gain_min", "pA", "0", -kMost, kMost,
                       "rma, ma: lower bound of the random gains (ma: 100)"),
      number_parameter("gain_max", "pA", "300", -kMost, kMost,
                       "rma, ma: upper bound of the random gains (ma: 100)"),
      number_parameter("bias_min", "pA", "0", -kMost, kMost,
                       "rma, ma: lower bound of the random bias currents (ma: 275)"),
      number_parameter("bias_max", "pA", "200", -kMost, kMost,
                       "rma, ma: upper bound of the random bias currents (ma: 475)"),
      {.name = "one_hot",
       .type = ParameterType::boolean,
       .default_value = "false",
       .text = "Each neuron encodes a single channel"},
      {.name = "spike_times",
       .type = ParameterType::choice,
       .default_value = "grid",
       .choices = {"grid", "interpolated"},
       .text = "grid: spike times are rounded up to a time grid, as in neural simulators; "
               "interpolated: they are exact"},
      number_parameter("resolution", "s", "0.001", 1e-6, 1, "Step of the time grid"),
      initial_of_encoder_parameter()};
  append_encoder_input_policy(parameters);
  return parameters;
}

NefModel nef_model(const Parameters& given) {
  check_keys(given);
  if (is_nengo(given)) {
    check_order(given, "max_rate_low", "max_rate_high");
    check_order(given, "intercept_low", "intercept_high");
    check_rates(given);
  } else {
    check_order(given, "gain_min", "gain_max");
    check_order(given, "bias_min", "bias_max");
  }
  const double tau = number(given, "tau_m");
  const double threshold = is_nengo(given) ? 1 : number(given, "v_th");
  return {.tau = tau * 1e9,
          // s / pF * pA in mV
          .scale = is_nengo(given) ? 1 : tau / number(given, "c_m") * 1e3,
          .threshold = threshold,
          .floor = is_nengo(given) ? 0 : -std::numeric_limits<double>::infinity(),
          .refractory = static_cast<double>(from_seconds(given.number("t_ref"))),
          .resolution = static_cast<double>(grid_of(given))};
}

void draw_nef_neurons(const NodeSetup& setup, std::uint32_t first, std::uint32_t count,
                      std::uint32_t dimensions, NefPopulation& population) {
  const Parameters& given = setup.parameters;
  const double threshold = is_nengo(given) ? 1 : number(given, "v_th");
  const RandomStream stream(setup.seed, setup.name);
  const bool one_hot = given.boolean("one_hot");
  const TuningDraw tunings(given);
  std::vector<double> direction(dimensions);
  for (std::uint32_t n = 0; n < count; ++n) {
    const std::uint64_t neuron = std::uint64_t{first} + n;
    one_hot ? draw_axis(stream, neuron, direction) : draw_direction(stream, neuron, direction);
    const Tuning tuning = tunings.draw(stream, neuron);
    // Below the threshold: uniform() is in (0, 1].
    const double potential = threshold * (1 - stream.uniform(neuron, kPotential));
    population.set_neuron(n, tuning.gain, tuning.bias, potential, direction);
  }
}

}  // namespace spikeloop
