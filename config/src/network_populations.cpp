#include "network_populations.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include "spikeloop/core/code.hpp"

namespace spikeloop {

namespace {

constexpr NeuronModel kModels[] = {NeuronModel::input,
                                   NeuronModel::repeater,
                                   NeuronModel::iaf_psc_delta,
                                   NeuronModel::iaf_psc_exp,
                                   NeuronModel::poisson,
                                   NeuronModel::signal_input,
                                   NeuronModel::step_current,
                                   NeuronModel::sine_current,
                                   NeuronModel::noise_current,
                                   NeuronModel::lin_rate_ipn,
                                   NeuronModel::threshold_lin_rate_ipn,
                                   NeuronModel::sigmoid_rate_ipn};

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kSmallest = 0.001;

ParameterDescription number(const char* name, const char* unit, std::optional<std::string> value,
                            const char* text, double minimum = -kInfinity,
                            double maximum = kInfinity) {
  ParameterDescription parameter;
  parameter.name = name;
  parameter.unit = unit;
  parameter.default_value = std::move(value);
  parameter.text = text;
  parameter.minimum = minimum;
  parameter.maximum = maximum;
  return parameter;
}

std::vector<ParameterDescription> membrane_parameters(NeuronModel model) {
  std::vector<ParameterDescription> list = {
      number("C_m", "pF", "250", "membrane capacitance", kSmallest),
      number("tau_m", "ms", "10", "membrane time constant", kSmallest),
      number("t_ref", "ms", "2", "absolute refractory period, rounded up to the grid", 0.0, 1e9),
      number("E_L", "mV", "-70", "resting potential"),
      number("V_reset", "mV", "-70", "membrane potential after a spike"),
      number("V_th", "mV", "-55", "threshold"),
      number("V_m", "mV", "-70", "membrane potential at time 0; E_L unless it is written"),
      number("I_e", "pA", "0", "constant input current")};
  if (model == NeuronModel::iaf_psc_exp) {
    list.push_back(
        number("tau_syn_ex", "ms", "2", "time constant of excitatory currents", kSmallest));
    list.push_back(
        number("tau_syn_in", "ms", "2", "time constant of inhibitory currents", kSmallest));
  } else {
    list.push_back(number("V_min", "mV", "-1e300",
                          "lower bound of the membrane potential; none unless it is written"));
  }
  return list;
}

std::vector<ParameterDescription> rate_parameters(NeuronModel model) {
  std::vector<ParameterDescription> list = {number("tau", "ms", "10", "time constant", kSmallest),
                                            number("lambda", "1", "1", "passive decay", 0.0),
                                            number("sigma", "1", "1", "noise", 0.0),
                                            number("mu", "1", "0", "mean drive"),
                                            number("g", "1", "1", "gain"),
                                            number("theta", "1", "0", "threshold"),
                                            number("rate", "1", "0", "rate at time 0")};
  if (model == NeuronModel::threshold_lin_rate_ipn) {
    list.push_back(number("alpha", "1", "1e300",
                          "upper bound of the gain function; none unless it is written", 0.0));
  } else if (model == NeuronModel::sigmoid_rate_ipn) {
    list.push_back(number("beta", "1", "1", "slope of the gain function"));
  }
  return list;
}

}  // namespace

std::string_view model_name(NeuronModel model) {
  switch (model) {
    case NeuronModel::input:
      return "input";
    case NeuronModel::repeater:
      return "repeater";
    case NeuronModel::iaf_psc_delta:
      return "iaf_psc_delta";
    case NeuronModel::iaf_psc_exp:
      return "iaf_psc_exp";
    case NeuronModel::poisson:
      return "poisson";
    case NeuronModel::signal_input:
      return "signal_input";
    case NeuronModel::step_current:
      return "step_current";
    case NeuronModel::sine_current:
      return "sine_current";
    case NeuronModel::noise_current:
      return "noise_current";
    case NeuronModel::lin_rate_ipn:
      return "lin_rate_ipn";
    case NeuronModel::threshold_lin_rate_ipn:
      return "threshold_lin_rate_ipn";
    case NeuronModel::sigmoid_rate_ipn:
      return "sigmoid_rate_ipn";
  }
  return "";
}

bool has_membrane(NeuronModel model) {
  return model == NeuronModel::iaf_psc_delta || model == NeuronModel::iaf_psc_exp;
}

bool is_current(NeuronModel model) {
  return model == NeuronModel::signal_input || model == NeuronModel::step_current ||
         model == NeuronModel::sine_current || model == NeuronModel::noise_current;
}

bool is_rate(NeuronModel model) {
  return model == NeuronModel::lin_rate_ipn || model == NeuronModel::threshold_lin_rate_ipn ||
         model == NeuronModel::sigmoid_rate_ipn;
}

bool is_source(NeuronModel model) {
  return model == NeuronModel::input || model == NeuronModel::poisson || is_current(model);
}

std::vector<ParameterDescription> model_parameters(NeuronModel model) {
  switch (model) {
    case NeuronModel::iaf_psc_delta:
    case NeuronModel::iaf_psc_exp:
      return membrane_parameters(model);
    case NeuronModel::sine_current:
      return {number("amplitude", "pA", std::nullopt, "amplitude"),
              number("frequency", "Hz", std::nullopt, "frequency", 0.0, 1e6),
              number("phase", "deg", "0", "phase at time 0"),
              number("offset", "pA", "0", "constant part")};
    case NeuronModel::noise_current:
      return {number("mean", "pA", "0", "mean"),
              number("std", "pA", std::nullopt, "standard deviation", 0.0),
              number("dt", "ms", "1", "time for which each value holds", 1e-6, 1e9)};
    case NeuronModel::lin_rate_ipn:
    case NeuronModel::threshold_lin_rate_ipn:
    case NeuronModel::sigmoid_rate_ipn:
      return rate_parameters(model);
    default:
      return {};
  }
}

namespace yaml_text {

namespace {

NeuronModel read_model(const Section& section) {
  const std::string name = section.text("model", "repeater");
  std::vector<std::string> names;
  for (const NeuronModel model : kModels) {
    if (model_name(model) == name) {
      return model;
    }
    names.emplace_back(model_name(model));
  }
  throw ConfigurationError(section.where("model"),
                           with_code(Code::unknown_choice, "{}: unknown model '{}'{}",
                                     section.what(), name, did_you_mean(name, names)));
}

std::uint32_t read_size(const Section& section) {
  const double size = section.quantity("size", "1", "100");
  if (size < 1 || size > kMostNeurons || size != std::floor(size)) {
    throw ConfigurationError(
        section.where("size"),
        with_code(Code::out_of_bounds,
                  "{}: size {} is not a whole number from 1 to {:.0f}; larger models belong in "
                  "NEST, NEURON or Brian2",
                  section.what(), section.text("size", "100"), kMostNeurons));
  }
  return static_cast<std::uint32_t>(size);
}

void check_potentials(const Parameters& given, const NeuronParameters& p, const Section& section) {
  const auto refuse = [&](const char* name, const std::string& message) {
    const Location& where = given.given(name) ? given.where(name) : section.where();
    throw ConfigurationError(where, fmt::format("{}: {}", section.what(), message));
  };
  if (p.V_reset >= p.V_th) {
    refuse(given.given("V_reset") ? "V_reset" : "V_th",
           with_code(Code::wrong_order,
                     "V_reset {} mV is not below V_th {} mV, so the neuron would never stop "
                     "firing; write a V_reset below V_th",
                     p.V_reset, p.V_th));
  }
  if (p.V_min > p.V_reset) {
    refuse("V_min", with_code(Code::wrong_order,
                              "V_min {} mV is above V_reset {} mV; write a V_min at or below "
                              "V_reset",
                              p.V_min, p.V_reset));
  }
}

Parameters given_parameters(const Section& section, NeuronModel model) {
  const std::vector<ParameterDescription> declared = model_parameters(model);
  const bool all_have_defaults = std::ranges::all_of(
      declared, [](const auto& parameter) { return parameter.default_value.has_value(); });
  if (all_have_defaults && !section.has("parameters")) {
    return resolve(declared, {}, {});
  }
  const char* const example = model == NeuronModel::sine_current
                                  ? "{amplitude: 100 pA, frequency: 10 Hz}"
                                  : "{std: 100 pA}";
  return resolve_section(Section(section.file(), section.what() + ": parameters",
                                 section.at("parameters", example), {}),
                         declared);
}

NeuronParameters read_membrane(const Section& section, NeuronModel model) {
  const Parameters given = given_parameters(section, model);
  NeuronParameters p;
  p.C_m = given.number("C_m");
  p.tau_m = given.number("tau_m");
  p.t_ref = given.number("t_ref");
  p.E_L = given.number("E_L");
  p.V_reset = given.number("V_reset");
  p.V_th = given.number("V_th");
  p.V_m = given.given("V_m") ? given.number("V_m") : p.E_L;
  p.I_e = given.number("I_e");
  if (model == NeuronModel::iaf_psc_exp) {
    p.tau_syn_ex = given.number("tau_syn_ex");
    p.tau_syn_in = given.number("tau_syn_in");
  } else if (given.given("V_min")) {
    p.V_min = given.number("V_min");
  }
  check_potentials(given, p, section);
  return p;
}

RateParameters read_rate(const Section& section, NeuronModel model) {
  const Parameters given = given_parameters(section, model);
  RateParameters p;
  p.tau = given.number("tau");
  p.lambda = given.number("lambda");
  p.sigma = given.number("sigma");
  p.mu = given.number("mu");
  p.g = given.number("g");
  p.theta = given.number("theta");
  p.rate = given.number("rate");
  if (model == NeuronModel::threshold_lin_rate_ipn && given.given("alpha")) {
    p.alpha = given.number("alpha");
  } else if (model == NeuronModel::sigmoid_rate_ipn) {
    p.beta = given.number("beta");
  }
  return p;
}

// A number, or a list of times and numbers. The times ascend, and lie on the grid.
std::vector<TimedValue> read_steps(const Section& section, const std::string& key,
                                   const std::string& unit, TimeNs resolution) {
  const std::string example = fmt::format("[[0 ms, 10 {0}], [100 ms, 20 {0}]]", unit);
  const YAML::Node& node = section.at(key, "10 " + unit);
  if (!node.IsSequence()) {
    return {{0, section.quantity(key, unit, "10 " + unit)}};
  }
  std::vector<TimedValue> steps;
  for (const auto& entry : node) {
    const Location where = place(section.file(), entry);
    if (!entry.IsSequence() || entry.size() != 2) {
      throw ConfigurationError(
          where, with_code(Code::wrong_shape,
                           "{}: {}: an entry is not a time with its value; write  {}: {}",
                           section.what(), key, key, example));
    }
    const auto number = [&](std::size_t i, const char* in) {
      try {
        return parse_quantity(scalar(section.file(), key, entry[i]), in);
      } catch (const ConfigurationError& error) {
        throw ConfigurationError(
            error.located() ? error.where() : place(section.file(), entry[i]),
            fmt::format("{}: {}: {}", section.what(), key,
                        error.located() ? "expected one value; write  " + key + ": " + example
                                        : error.what()));
      }
    };
    const double ms = number(0, "ms");
    const bool in_range = ms >= 0 && ms <= 1e9;
    const TimeNs time = in_range ? std::llround(ms * 1e6) : 0;
    if (!in_range || std::abs(ms * 1e6 - static_cast<double>(time)) > 1e-3) {
      throw ConfigurationError(
          where, with_code(Code::off_grid,
                           "{}: {}: the time {} ms is not a whole number of nanoseconds from 0 "
                           "to 1e9 ms; write  {}: {}",
                           section.what(), key, ms, key, example));
    }
    check_on_grid(fmt::format("{}: {}: the time", section.what(), key), time, resolution, where);
    if (!steps.empty() && time <= steps.back().time) {
      throw ConfigurationError(
          where, with_code(Code::wrong_order,
                           "{}: {}: {} does not come after {}; write the times in their order",
                           section.what(), key, format_time(time), format_time(steps.back().time)));
    }
    steps.push_back({time, number(1, unit.c_str())});
  }
  if (steps.empty()) {
    throw ConfigurationError(section.where(key),
                             with_code(Code::network, "{}: {} is empty; write  {}: {}",
                                       section.what(), key, key, example));
  }
  return steps;
}

void check_rates(const Section& section, const std::vector<TimedValue>& rates) {
  constexpr double kMostHz = 1e6;
  for (const TimedValue& rate : rates) {
    if (rate.value < 0 || rate.value > kMostHz) {
      throw ConfigurationError(
          section.where("rate"),
          with_code(Code::out_of_bounds,
                    "{}: rate {} Hz is not from 0 to {:.0f} Hz; write for example  rate: 10 Hz",
                    section.what(), rate.value, kMostHz));
    }
  }
}

void refuse_parameters(const Section& section, NeuronModel model) {
  if (section.has("parameters")) {
    throw ConfigurationError(
        section.where("parameters"),
        with_code(Code::network, "{}: model {} has no parameters; leave the key 'parameters' out",
                  section.what(), model_name(model)));
  }
}

}  // namespace

void check_on_grid(const std::string& what, TimeNs time, TimeNs resolution, const Location& where) {
  if (resolution != 0 && time % resolution != 0) {
    const TimeNs below = time / resolution * resolution;
    throw ConfigurationError(
        where,
        with_code(Code::off_grid, "{} {} is not a multiple of the resolution {}; write {}{}", what,
                  format_time(time), format_time(resolution),
                  below == 0 ? "" : format_time(below) + " or ", format_time(below + resolution)));
  }
}

SourceParameters read_source(const Section& section, NeuronModel model, TimeNs resolution) {
  SourceParameters source;
  if (model == NeuronModel::poisson || model == NeuronModel::step_current) {
    const bool rates = model == NeuronModel::poisson;
    const std::string key = rates ? "rate" : "values";
    const Section values(section.file(), section.what() + ": parameters",
                         section.at("parameters", rates ? "{rate: 10 Hz}" : "{values: 100 pA}"),
                         {key});
    source.steps = read_steps(values, key, rates ? "Hz" : "pA", resolution);
    if (rates) {
      check_rates(values, source.steps);
    }
    return source;
  }
  const Parameters given = given_parameters(section, model);
  if (model == NeuronModel::sine_current) {
    constexpr double kPi = 3.14159265358979323846;
    source.amplitude = given.number("amplitude");
    source.frequency = given.number("frequency");
    source.phase = given.number("phase") * kPi / 180.0;
    source.offset = given.number("offset");
    return source;
  }
  source.mean = given.number("mean");
  source.std = given.number("std");
  source.dt = std::llround(given.number("dt") * 1e6);
  check_on_grid(section.what() + ": dt", source.dt, resolution,
                given.given("dt") ? given.where("dt") : section.where());
  return source;
}

NetworkPopulation read_population(const NetworkFile& network, const Section& populations,
                                  const std::string& name) {
  const Section section(network.path, fmt::format("population '{}'", name),
                        populations.at(name, ""), {"model", "size", "parameters"});
  NetworkPopulation population;
  population.name = name;
  population.where = section.where();
  population.model = read_model(section);
  population.size = read_size(section);
  const NeuronModel model = population.model;
  if (network.resolution == 0 &&
      (model == NeuronModel::iaf_psc_exp || is_current(model) || is_rate(model))) {
    throw ConfigurationError(
        section.where("model"),
        with_code(Code::off_grid,
                  "{}: model {} is computed on a grid, but the resolution is off; write  "
                  "resolution: 0.1 ms",
                  section.what(), model_name(model)));
  }
  if (has_membrane(model)) {
    population.parameters = read_membrane(section, model);
  } else if (is_rate(model)) {
    population.rate = read_rate(section, model);
  } else if (is_source(model) && model != NeuronModel::input &&
             model != NeuronModel::signal_input) {
    population.source = read_source(section, model, network.resolution);
  } else {
    refuse_parameters(section, model);
  }
  return population;
}

}  // namespace yaml_text

}  // namespace spikeloop
