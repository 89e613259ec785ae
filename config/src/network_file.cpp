#include "spikeloop/config/network_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "network_connections.hpp"
#include "spikeloop/config/weight_file.hpp"
#include "text_file.hpp"
#include "yaml_section.hpp"

namespace spikeloop {

namespace {

using yaml_text::place;
using yaml_text::Section;

constexpr TimeNs kDefaultResolution = 100'000;  // NEST's 0.1 ms
constexpr double kMostNeurons = 10'000'000;
constexpr NeuronModel kModels[] = {NeuronModel::input, NeuronModel::repeater,
                                   NeuronModel::iaf_psc_delta, NeuronModel::iaf_psc_exp};

bool has_membrane(NeuronModel model) {
  return model == NeuronModel::iaf_psc_delta || model == NeuronModel::iaf_psc_exp;
}

ParameterDescription number(const char* name, const char* unit, std::optional<std::string> value,
                            const char* text,
                            double minimum = -std::numeric_limits<double>::infinity(),
                            double maximum = std::numeric_limits<double>::infinity()) {
  ParameterDescription parameter;
  parameter.name = name;
  parameter.unit = unit;
  parameter.default_value = std::move(value);
  parameter.text = text;
  parameter.minimum = minimum;
  parameter.maximum = maximum;
  return parameter;
}

TimeNs read_resolution(const Section& section) {
  if (!section.has("resolution")) {
    return kDefaultResolution;
  }
  return section.text("resolution", "0.1 ms") == "off" ? 0 : section.time("resolution", "0.1 ms");
}

NeuronModel read_model(const Section& section) {
  const std::string name = section.text("model", "repeater");
  std::vector<std::string> names;
  for (const NeuronModel model : kModels) {
    if (model_name(model) == name) {
      return model;
    }
    names.emplace_back(model_name(model));
  }
  throw ConfigurationError(
      section.where("model"),
      fmt::format("{}: unknown model '{}'{}", section.what(), name, did_you_mean(name, names)));
}

std::uint32_t read_size(const Section& section) {
  const double size = section.quantity("size", "1", "100");
  if (size < 1 || size > kMostNeurons || size != std::floor(size)) {
    throw ConfigurationError(
        section.where("size"),
        fmt::format("{}: size {} is not a whole number from 1 to {:.0f}; larger models belong in "
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
           fmt::format("V_reset {} mV is not below V_th {} mV, so the neuron would never stop "
                       "firing; write a V_reset below V_th",
                       p.V_reset, p.V_th));
  }
  if (p.V_min > p.V_reset) {
    refuse("V_min", fmt::format("V_min {} mV is above V_reset {} mV; write a V_min at or below "
                                "V_reset",
                                p.V_min, p.V_reset));
  }
}

NeuronParameters read_parameters(const Section& section, NeuronModel model) {
  NeuronParameters p;
  if (!has_membrane(model)) {
    if (section.has("parameters")) {
      throw ConfigurationError(
          section.where("parameters"),
          fmt::format("{}: model {} has no parameters; leave the key 'parameters' out",
                      section.what(), model_name(model)));
    }
    return p;
  }
  WrittenValues written;
  if (section.has("parameters")) {
    const Section values(section.file(), section.what() + ": parameters",
                         section.at("parameters", "{}"), {});
    for (const std::string& key : values.keys()) {
      written[key] = {values.text(key, ""), values.where(key)};
    }
  }
  const Parameters given = resolve(model_parameters(model), written, {});
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

NetworkPopulation read_population(const NetworkFile& network, const Section& populations,
                                  const std::string& name) {
  const Section section(network.path, fmt::format("population '{}'", name),
                        populations.at(name, ""), {"model", "size", "parameters"});
  NetworkPopulation population;
  population.name = name;
  population.where = section.where();
  population.model = read_model(section);
  population.size = read_size(section);
  population.parameters = read_parameters(section, population.model);
  if (network.resolution == 0 && has_membrane(population.model)) {
    throw ConfigurationError(
        section.where("model"),
        fmt::format("{}: model {} is computed on a grid, but the resolution is off; write  "
                    "resolution: 0.1 ms",
                    section.what(), model_name(population.model)));
  }
  return population;
}

void check_total(const NetworkFile& network, const Section& populations) {
  double total = 0;
  for (const auto& population : network.populations) {
    total += population.size;
  }
  if (total > kMostNeurons) {
    throw ConfigurationError(
        populations.where(),
        fmt::format("{} have {:.0f} members together, more than the {:.0f} this network takes; "
                    "larger models belong in NEST, NEURON or Brian2",
                    populations.what(), total, kMostNeurons));
  }
}

void read_output(const YAML::Node& list, NetworkFile& network) {
  if (!list.IsSequence() || list.size() == 0) {
    throw ConfigurationError(place(network.path, list),
                             "key 'output': expected a list of populations; write  output: [name]");
  }
  for (const auto& entry : list) {
    const std::string name = yaml_text::scalar(network.path, "output", entry);
    const Location where = place(network.path, entry);
    const std::size_t index = yaml_text::find_population(network, name, where, "key 'output'");
    if (network.populations[index].model == NeuronModel::input) {
      throw ConfigurationError(where, fmt::format("key 'output': '{}' is an input; connect it to a "
                                                  "repeater and write the repeater's name",
                                                  name));
    }
    if (std::find(network.output.begin(), network.output.end(), index) != network.output.end()) {
      throw ConfigurationError(
          where, fmt::format("key 'output': population '{}' is named twice; write it once", name));
    }
    network.output.push_back(index);
  }
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
  }
  return "";
}

std::vector<ParameterDescription> model_parameters(NeuronModel model) {
  if (!has_membrane(model)) {
    return {};
  }
  constexpr double kSmallest = 0.001;
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
                          "lower bound of the membrane potential; none "
                          "unless it is written"));
  }
  return list;
}

std::uint32_t NetworkFile::input_width() const {
  std::uint32_t width = 0;
  for (const auto& population : populations) {
    width += population.model == NeuronModel::input ? population.size : 0;
  }
  return width;
}

std::uint32_t NetworkFile::output_width() const {
  std::uint32_t width = 0;
  for (const std::size_t index : output) {
    width += populations[index].size;
  }
  return width;
}

void NetworkFile::check_tick(TimeNs tick) const {
  if (resolution != 0 && tick % resolution != 0) {
    const TimeNs below = tick / resolution * resolution;
    throw ConfigurationError(
        resolution_where,
        fmt::format("the tick {} is not a whole number of the network's resolution "
                    "{}; write a tick of {} or another resolution",
                    format_time(tick), format_time(resolution),
                    format_time(below == 0 ? resolution : below)));
  }
}

NetworkFile parse_network(const std::string& text, const std::string& path,
                          const NetworkWeightLoader& load_weights) {
  const YAML::Node root = yaml_text::load(text, path, "network");
  const Section file(path, "network file", root,
                     {"resolution", "populations", "connections", "output"});
  NetworkFile network;
  network.path = path;
  network.resolution = read_resolution(file);
  network.resolution_where =
      file.has("resolution") ? file.where("resolution") : Location{path, 0, 0};
  const Section populations(path, "key 'populations'",
                            file.at("populations", "{relay: {model: repeater, size: 1}}"), {});
  for (const std::string& name : populations.keys()) {
    network.populations.push_back(read_population(network, populations, name));
  }
  check_total(network, populations);
  if (file.has("connections")) {
    const YAML::Node& list = file.at("connections", "");
    if (!list.IsSequence()) {
      throw ConfigurationError(file.where("connections"),
                               "key 'connections': expected a list; write lines of  - {from: a, "
                               "to: b, rule: one_to_one, weight: 1, delay: 1 ms}");
    }
    for (std::size_t i = 0; i < list.size(); ++i) {
      network.projections.push_back(yaml_text::read_connection(network, i, list[i], load_weights));
    }
  }
  read_output(file.at("output", "[name of a population]"), network);
  return network;
}

NetworkFile read_network_file(const std::string& path) {
  constexpr std::uint64_t kMostBytes = 100'000'000;
  return parse_network(
      read_text_file(path, kMostBytes, "network file"), path,
      [](const std::string& weights) { return read_weights(weights, {.short_forms = false}); });
}

}  // namespace spikeloop
