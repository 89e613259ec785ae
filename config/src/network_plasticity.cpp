#include "network_plasticity.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <set>

#include "network_connections.hpp"
#include "network_populations.hpp"
#include "spikeloop/core/code.hpp"

namespace spikeloop {

std::string_view rule_name(PlasticityRule rule) {
  switch (rule) {
    case PlasticityRule::stdp:
      return "stdp";
    case PlasticityRule::stdp_dopamine:
      return "stdp_dopamine";
    case PlasticityRule::reward_hebbian:
      return "reward_hebbian";
  }
  return "";
}

namespace yaml_text {

namespace {

ParameterDescription number(const char* name, const std::string& unit, const char* value,
                            double minimum = -std::numeric_limits<double>::infinity()) {
  ParameterDescription parameter;
  parameter.name = name;
  parameter.unit = unit;
  parameter.default_value = value;
  parameter.minimum = minimum;
  return parameter;
}

ParameterDescription text(const char* name, std::optional<std::string> value) {
  ParameterDescription parameter;
  parameter.name = name;
  parameter.type = ParameterType::text;
  parameter.default_value = std::move(value);
  return parameter;
}

std::vector<ParameterDescription> parameters_of(PlasticityRule rule, const std::string& unit) {
  constexpr double kSmallest = 0.001;
  if (rule == PlasticityRule::reward_hebbian) {
    return {text("rule", std::nullopt),   text("save", ""),
            text("reward", std::nullopt), number("A", "1", "0.01"),
            number("theta", "1", "0"),    number("Wmin", unit, "0"),
            number("Wmax", unit, "1"),    number("trace_delay", "ms", "1", 0)};
  }
  std::vector<ParameterDescription> list = {
      text("rule", std::nullopt), text("pairing", "all_to_all"), text("save", ""),
      number("tau_plus", "ms", "20", kSmallest), number("tau_minus", "ms", "20", kSmallest)};
  const bool stdp = rule == PlasticityRule::stdp;
  const std::vector<ParameterDescription> own =
      stdp ? std::vector{number("lambda", "1", "0.01", 0), number("alpha", "1", "1", 0),
                         number("mu_plus", "1", "1", 0), number("mu_minus", "1", "1", 0),
                         number("Wmax", unit, "100")}
           : std::vector{number("A_plus", "1", "1"),
                         number("A_minus", "1", "1.5"),
                         number("tau_c", "ms", "1000", kSmallest),
                         number("tau_n", "ms", "200", kSmallest),
                         number("b", "1", "0"),
                         number("Wmin", unit, "0"),
                         number("Wmax", unit, "200"),
                         text("reward", std::nullopt),
                         number("reward_delay", "ms", "1", 0)};
  list.insert(list.end(), own.begin(), own.end());
  return list;
}

PlasticityRule read_rule(const Section& section) {
  const std::string name = section.text("rule", "stdp");
  for (const PlasticityRule rule :
       {PlasticityRule::stdp, PlasticityRule::stdp_dopamine, PlasticityRule::reward_hebbian}) {
    if (name == rule_name(rule)) {
      return rule;
    }
  }
  throw ConfigurationError(
      section.where("rule"),
      with_code(Code::unknown_choice, "{}: unknown rule '{}'{}", section.what(), name,
                did_you_mean(name, {"stdp", "stdp_dopamine", "reward_hebbian"})));
}

// Spikes and rates have rules of their own.
void check_rule(const Section& section, PlasticityRule rule, bool rates) {
  if (rates != (rule == PlasticityRule::reward_hebbian)) {
    throw ConfigurationError(
        section.where("rule"),
        with_code(Code::network, "{}: rule {} is for {}; write  rule: {}", section.what(),
                  rule_name(rule), rates ? "spikes" : "rate neurons",
                  rates ? "reward_hebbian" : "stdp"));
  }
}

bool read_pairing(const Section& section, const Parameters& given) {
  const std::string& pairing = given.text("pairing");
  if (pairing != "all_to_all" && pairing != "nearest") {
    throw ConfigurationError(
        given.where("pairing"),
        with_code(Code::unknown_choice, "{}: unknown pairing '{}'{}", section.what(), pairing,
                  did_you_mean(pairing, {"all_to_all", "nearest"})));
  }
  return pairing == "nearest";
}

void read_reward(const NetworkFile& network, const Section& section, const Parameters& given,
                 NetworkPlasticity& plasticity) {
  const Location where = given.where("reward");
  plasticity.reward = find_population(network, given.text("reward"), where, section.what());
  const NetworkPopulation& population = network.populations[plasticity.reward];
  const bool signal = population.model == NeuronModel::signal_input;
  if ((is_current(population.model) || is_rate(population.model)) && !signal) {
    throw ConfigurationError(
        where, with_code(Code::network,
                         "{}: reward '{}' is a {}; write a population with spikes, or a "
                         "signal_input",
                         section.what(), population.name, model_name(population.model)));
  }
  if (signal && given.given("reward_delay")) {
    throw ConfigurationError(
        given.where("reward_delay"),
        with_code(Code::delay, "{}: the signal '{}' acts at once; leave reward_delay out",
                  section.what(), population.name));
  }
  if (signal) {
    return;
  }
  plasticity.reward_delay =
      section.has("reward_delay") ? section.time("reward_delay", "1 ms") : 1'000'000;
  const Location here = given.given("reward_delay") ? given.where("reward_delay") : section.where();
  check_delay(section.what() + ": reward_delay", plasticity.reward_delay, network.resolution, here);
}

void read_stdp(const NetworkFile& network, const Section& section, const Parameters& given,
               NetworkPlasticity& p) {
  p.nearest = read_pairing(section, given);
  p.tau_plus = given.number("tau_plus");
  p.tau_minus = given.number("tau_minus");
  if (p.rule == PlasticityRule::stdp) {
    p.lambda = given.number("lambda");
    p.alpha = given.number("alpha");
    p.mu_plus = given.number("mu_plus");
    p.mu_minus = given.number("mu_minus");
    return;
  }
  p.A_plus = given.number("A_plus");
  p.A_minus = given.number("A_minus");
  p.tau_c = given.number("tau_c");
  p.tau_n = given.number("tau_n");
  p.b = given.number("b");
  p.Wmin = given.number("Wmin");
  read_reward(network, section, given, p);
}

void read_reward_neuron(const NetworkFile& network, const Section& section, const Parameters& given,
                        NetworkPlasticity& plasticity) {
  const Location where = given.where("reward");
  plasticity.reward = find_population(network, given.text("reward"), where, section.what());
  const NetworkPopulation& population = network.populations[plasticity.reward];
  if (!is_rate(population.model) || population.size != 1) {
    throw ConfigurationError(
        where,
        with_code(Code::network,
                  "{}: reward '{}' is a {} of size {}; write a population of one rate neuron",
                  section.what(), population.name, model_name(population.model), population.size));
  }
}

void read_trace_delay(const NetworkFile& network, const NetworkProjection& projection,
                      const Section& section, NetworkPlasticity& plasticity) {
  plasticity.trace_delay = network.resolution;
  if (section.has("trace_delay")) {
    const std::string what = section.what() + ": trace_delay";
    const Location where = section.where("trace_delay");
    plasticity.trace_delay = section.time("trace_delay", "1 ms");
    check_delay(what, plasticity.trace_delay, network.resolution, where);
    for (const std::size_t end : {projection.from, projection.to}) {
      check_buffer(what, plasticity.trace_delay, network.resolution, network.populations[end].size,
                   "members", where);
    }
  }
}

void check_bounds(const NetworkPlasticity& plasticity, const NetworkProjection& projection,
                  const Section& section, const std::string& unit) {
  const bool stdp = plasticity.rule == PlasticityRule::stdp;
  const std::string in = unit == "1" ? "" : " " + unit;
  const double low = stdp ? std::min(0.0, plasticity.Wmax) : plasticity.Wmin;
  const double high = stdp ? std::max(0.0, plasticity.Wmax) : plasticity.Wmax;
  if (low >= high) {
    throw ConfigurationError(
        section.has("Wmax") ? section.where("Wmax") : section.where(),
        stdp
            ? with_code(Code::wrong_order, "{}: Wmax 0 leaves weights no room; write  Wmax: 100 {}",
                        section.what(), unit)
            : with_code(Code::wrong_order,
                        "{}: Wmin {}{} is not below Wmax {}{}; write a Wmin below Wmax",
                        section.what(), low, in, high, in));
  }
  for (const double weight : projection.weight) {
    if (weight < low || weight > high) {
      throw ConfigurationError(
          projection.where,
          with_code(Code::out_of_bounds,
                    "{}: the weight {}{} is not from {} to {}{}; write a weight in these "
                    "bounds, or other bounds",
                    section.what(), weight, in, low, high, in));
    }
  }
}

// A table has one place for every pair of a source and a target.
void check_save(const NetworkProjection& projection, const Section& section,
                const std::string& save) {
  if (!save.ends_with(".npy") && !save.ends_with(".json")) {
    throw ConfigurationError(
        section.where("save"),
        with_code(Code::network,
                  "{}: save '{}' ends in neither .npy nor .json; write for example  save: "
                  "learned.npy",
                  section.what(), save));
  }
  if (save.find('/') != std::string::npos) {
    throw ConfigurationError(
        section.where("save"),
        with_code(Code::network,
                  "{}: save '{}' is a path; write the name of a file alone, which comes to lie "
                  "in the run folder",
                  section.what(), save));
  }
  for (std::size_t i = 0; i + 1 < projection.row_start.size(); ++i) {
    std::set<std::uint32_t> seen;
    for (std::uint64_t k = projection.row_start[i]; k < projection.row_start[i + 1]; ++k) {
      if (!seen.insert(projection.target[k]).second) {
        throw ConfigurationError(
            section.where("save"),
            with_code(Code::network,
                      "{}: there are two synapses from {} to {}, which a table of weights cannot "
                      "hold; leave 'save' out, or write the pair once",
                      section.what(), i, projection.target[k]));
      }
    }
  }
}

}  // namespace

NetworkPlasticity read_plasticity(const NetworkFile& network, const NetworkProjection& projection,
                                  const std::string& what, const YAML::Node& node) {
  const Section section(network.path, what + ": plasticity", node, {});
  const NetworkPopulation& to = network.populations[projection.to];
  const bool rates = is_rate(to.model);
  if (!has_membrane(to.model) && !rates) {
    throw ConfigurationError(
        section.where(), with_code(Code::network,
                                   "{}: a {} does not learn; leave 'plasticity' out, or connect "
                                   "an iaf_psc_delta or iaf_psc_exp",
                                   section.what(), model_name(to.model)));
  }
  if (is_current(network.populations[projection.from].model)) {
    throw ConfigurationError(
        section.where(), with_code(Code::network, "{}: a {} does not learn; leave 'plasticity' out",
                                   section.what(), rates ? "signal" : "current"));
  }
  if (network.resolution == 0) {
    throw ConfigurationError(section.where(),
                             with_code(Code::off_grid,
                                       "{}: learning is computed on a grid, but the resolution is "
                                       "off; write  resolution: 0.1 ms",
                                       section.what()));
  }
  const std::string unit = unit_of_weight(to.model);
  NetworkPlasticity p;
  p.where = section.where();
  p.rule = read_rule(section);
  check_rule(section, p.rule, rates);
  const Parameters given = resolve_section(section, parameters_of(p.rule, unit));
  p.Wmax = given.number("Wmax");
  if (rates) {
    p.A = given.number("A");
    p.theta = given.number("theta");
    p.Wmin = given.number("Wmin");
    read_reward_neuron(network, section, given, p);
    read_trace_delay(network, projection, section, p);
  } else {
    read_stdp(network, section, given, p);
  }
  check_bounds(p, projection, section, unit);
  p.save = given.text("save");
  if (!p.save.empty()) {
    check_save(projection, section, p.save);
  }
  return p;
}

}  // namespace yaml_text

}  // namespace spikeloop
