#include "network_connections.hpp"

#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <numeric>

#include "network_plasticity.hpp"
#include "network_populations.hpp"
#include "spikeloop/config/weight_file.hpp"
#include "spikeloop/core/code.hpp"
#include "yaml_json.hpp"

namespace spikeloop::yaml_text {

namespace {

constexpr std::uint64_t kMostSynapses = 100'000'000;
constexpr std::uint64_t kMostBufferEntries = 20'000'000;
const char* const kElsewhere = "; larger models belong in NEST, NEURON or Brian2";

struct Synapse {
  std::uint32_t source = 0;
  std::uint32_t target = 0;
  double weight = 0.0;
};

struct Ends {
  const NetworkPopulation& from;
  const NetworkPopulation& to;
};

// A repeater answers every spike with one spike, as NEST's parrot_neuron does: a weight other than
// 1 would be ignored, so it is refused.
void check_repeater_weight(const Ends& ends, double weight, const Location& where) {
  if (ends.to.model == NeuronModel::repeater && weight != 1.0) {
    throw ConfigurationError(
        where, with_code(Code::network,
                         "weight {} into repeater '{}': a repeater repeats every spike once, "
                         "whatever its weight; write 1 or leave the weight out",
                         weight, ends.to.name));
  }
}

double read_weight(const Section& section, const Ends& ends) {
  const NeuronModel from = ends.from.model;
  const bool factor = is_current(from) && from != NeuronModel::signal_input;
  const std::string unit = factor || is_rate(ends.to.model)    ? "1"
                           : from == NeuronModel::signal_input ? "pA"
                                                               : unit_of_weight(ends.to.model);
  if (unit == "1" && !section.has("weight")) {
    return 1.0;
  }
  const double weight = section.quantity("weight", unit, "100 " + unit);
  check_repeater_weight(ends, weight, section.where("weight"));
  return weight;
}

TimeNs read_delay(const Section& section, const Ends& ends, TimeNs resolution) {
  if (is_current(ends.from.model)) {
    if (section.has("delay")) {
      throw ConfigurationError(
          section.where("delay"),
          with_code(Code::delay, "{}: the {} of '{}' acts at once; leave the delay out",
                    section.what(), is_rate(ends.to.model) ? "signal" : "current", ends.from.name));
    }
    return 0;
  }
  if (is_rate(ends.from.model)) {
    const bool delayed = section.has("delay") && section.quantity("delay", "ms", "1 ms") != 0.0;
    const TimeNs delay = delayed ? section.time("delay", "1 ms") : 0;
    check_on_grid("delay", delay, resolution, section.where("delay"));
    check_buffer("delay", delay, resolution, ends.from.size, "sources", section.where("delay"));
    return delay;
  }
  const TimeNs delay = section.time("delay", "1 ms");
  if (resolution == 0) {
    return delay;
  }
  check_delay("delay", delay, resolution, section.where("delay"));
  const std::uint32_t wide = ends.to.model == NeuronModel::repeater ? 1 : ends.to.size;
  check_buffer("delay", delay, resolution, wide, "targets", section.where("delay"));
  return delay;
}

void check_target(const Section& section, const Ends& ends) {
  if (is_source(ends.to.model)) {
    throw ConfigurationError(
        section.where("to"),
        ends.to.model == NeuronModel::input
            ? with_code(Code::network,
                        "{}: '{}' is an input, it only gets what arrives at port 'in'; write a "
                        "population of neurons or repeaters",
                        section.what(), ends.to.name)
            : with_code(Code::network,
                        "{}: '{}' is a {}, nothing can be connected to it; write a population "
                        "of neurons or repeaters",
                        section.what(), ends.to.name, model_name(ends.to.model)));
  }
  if (is_rate(ends.to.model)) {
    if (!is_rate(ends.from.model) && ends.from.model != NeuronModel::signal_input) {
      throw ConfigurationError(
          section.where("from"),
          with_code(Code::network,
                    "{}: rate neurons take rates and signals, but '{}' is of model {}; write a "
                    "population of rate neurons or a signal_input",
                    section.what(), ends.from.name, model_name(ends.from.model)));
    }
    return;
  }
  if (is_rate(ends.from.model)) {
    throw ConfigurationError(
        section.where("to"),
        with_code(Code::network,
                  "{}: '{}' is of model {}, which takes no rate; write a population of model "
                  "lin_rate_ipn, threshold_lin_rate_ipn or sigmoid_rate_ipn",
                  section.what(), ends.to.name, model_name(ends.to.model)));
  }
  if (is_current(ends.from.model) && !has_membrane(ends.to.model)) {
    throw ConfigurationError(
        section.where("to"),
        with_code(Code::network,
                  "{}: '{}' is a {}, which takes no current; write a population of model "
                  "iaf_psc_delta or iaf_psc_exp",
                  section.what(), ends.to.name, model_name(ends.to.model)));
  }
}

void check_count(std::uint64_t synapses, const Location& where) {
  if (synapses > kMostSynapses) {
    throw ConfigurationError(
        where,
        with_code(Code::out_of_bounds, "{} synapses are more than the {} this network takes{}",
                  synapses, kMostSynapses, kElsewhere));
  }
}

std::vector<Synapse> one_to_one(const Ends& ends, double weight, const Location& where) {
  if (ends.from.size != ends.to.size) {
    throw ConfigurationError(
        where, with_code(Code::weights_differ,
                         "rule one_to_one needs populations of one size, but '{}' has {} and "
                         "'{}' has {}; write all_to_all, pairs or a weight file",
                         ends.from.name, ends.from.size, ends.to.name, ends.to.size));
  }
  std::vector<Synapse> synapses(ends.from.size);
  for (std::uint32_t i = 0; i < ends.from.size; ++i) {
    synapses[i] = {i, i, weight};
  }
  return synapses;
}

std::vector<Synapse> all_to_all(const Ends& ends, double weight, const Location& where) {
  check_count(std::uint64_t{ends.from.size} * ends.to.size, where);
  std::vector<Synapse> synapses;
  synapses.reserve(std::size_t{ends.from.size} * ends.to.size);
  for (std::uint32_t i = 0; i < ends.from.size; ++i) {
    for (std::uint32_t j = 0; j < ends.to.size; ++j) {
      synapses.push_back({i, j, weight});
    }
  }
  return synapses;
}

Synapse read_pair(const std::string& file, const YAML::Node& node, const Ends& ends,
                  double weight) {
  if (!node.IsSequence() || node.size() < 2 || node.size() > 3) {
    throw ConfigurationError(
        place(file, node),
        with_code(Code::wrong_shape,
                  "pairs: an entry is not a pair; write [source, target] or [source, "
                  "target, factor], for example [0, 1] or [0, 1, -0.5]"));
  }
  Synapse synapse{read_index(file, "pairs", node[0], ends.from),
                  read_index(file, "pairs", node[1], ends.to), weight};
  if (node.size() == 3) {
    const std::string factor = scalar(file, "pairs", node[2]);
    try {
      synapse.weight *= parse_quantity(factor, "1");
    } catch (const ConfigurationError& error) {
      throw ConfigurationError(place(file, node[2]), fmt::format("pairs: {}", error.what()));
    }
    check_repeater_weight(ends, synapse.weight, place(file, node[2]));
  }
  return synapse;
}

std::vector<Synapse> pairs(const Section& section, const Ends& ends, double weight) {
  const YAML::Node& list = section.at("pairs", "[[0, 0], [1, 0]]");
  if (!list.IsSequence()) {
    throw ConfigurationError(
        section.where("pairs"),
        with_code(Code::wrong_shape,
                  "key 'pairs': expected a list; write  pairs: [[0, 0], [1, 0]]"));
  }
  std::vector<Synapse> synapses;
  for (const auto& entry : list) {
    synapses.push_back(read_pair(section.file(), entry, ends, weight));
  }
  return synapses;
}

bool is_table(const Section& section) {
  return section.has("rule") && section.at("rule", "").IsSequence();
}

/// Written as the rule, or in the file of that name.
WeightTable load(const std::string& rule, const Section& section,
                 const NetworkWeightLoader& load_weights) {
  try {
    if (is_table(section)) {
      return parse_weights(to_json(section.file(), section.at("rule", "")), rule);
    }
    // operator/ keeps an absolute rule as it is.
    return load_weights((std::filesystem::path(section.file()).parent_path() / rule).string());
  } catch (const ConfigurationError& error) {
    throw ConfigurationError(section.where("rule"), fmt::format("key 'rule': {}", error.what()));
  }
}

std::vector<Synapse> from_table(const std::string& rule, const Section& section, const Ends& ends,
                                double weight, const NetworkWeightLoader& load_weights) {
  const Location where = section.where("rule");
  WeightTable table = load(rule, section, load_weights);
  const bool fits = (table.rows == 0 || table.rows == ends.to.size) &&
                    (table.columns == 0 || table.columns == ends.from.size);
  if (!fits) {
    throw ConfigurationError(
        where, with_code(Code::weights_differ,
                         "'{}' has {} rows and {} columns, but '{}' has {} neurons and '{}' has "
                         "{}; write one row a target and one column a source",
                         rule, table.rows, table.columns, ends.to.name, ends.to.size,
                         ends.from.name, ends.from.size));
  }
  table = table.resized(ends.to.size, ends.from.size).compressed();
  check_count(table.column.size(), where);
  std::vector<Synapse> synapses;
  synapses.reserve(table.column.size());
  for (std::uint32_t row = 0; row < table.rows; ++row) {
    for (std::uint64_t k = table.row_start[row]; k < table.row_start[row + 1]; ++k) {
      check_repeater_weight(ends, weight * table.values[k], where);
      synapses.push_back({table.column[k], row, weight * table.values[k]});
    }
  }
  return synapses;
}

std::vector<Synapse> apply_rule(const std::string& rule, const Section& section, const Ends& ends,
                                const NetworkWeightLoader& load_weights) {
  const double weight = read_weight(section, ends);
  const Location where = section.where("rule");
  if (rule != "pairs" && section.has("pairs")) {
    throw ConfigurationError(
        section.where("pairs"),
        with_code(Code::conflicting_keys,
                  "key 'pairs' is read with rule pairs only, but the rule is '{}'; write  rule: "
                  "pairs",
                  rule));
  }
  if (rule == "one_to_one") {
    return one_to_one(ends, weight, where);
  }
  if (rule == "all_to_all") {
    return all_to_all(ends, weight, where);
  }
  if (rule == "pairs") {
    return pairs(section, ends, weight);
  }
  if (is_table(section) || rule.ends_with(".json") || rule.ends_with(".npy")) {
    return from_table(rule, section, ends, weight, load_weights);
  }
  throw ConfigurationError(
      where, with_code(Code::unknown_choice,
                       "unknown rule '{}'{}; write one_to_one, all_to_all, pairs, a table of "
                       "weights or a weight file that ends in .json or .npy",
                       rule, did_you_mean(rule, {"one_to_one", "all_to_all", "pairs"})));
}

// A counting sort by source; the order of one source's synapses stays.
void group_by_source(const std::vector<Synapse>& synapses, std::uint32_t sources,
                     NetworkProjection& projection) {
  projection.row_start.assign(std::size_t{sources} + 1, 0);
  for (const Synapse& synapse : synapses) {
    ++projection.row_start[synapse.source + 1];
  }
  std::partial_sum(projection.row_start.begin(), projection.row_start.end(),
                   projection.row_start.begin());
  std::vector<std::uint64_t> next(projection.row_start.begin(), projection.row_start.end() - 1);
  projection.target.resize(synapses.size());
  projection.weight.resize(synapses.size());
  for (const Synapse& synapse : synapses) {
    const std::uint64_t k = next[synapse.source]++;
    projection.target[k] = synapse.target;
    projection.weight[k] = synapse.weight;
  }
}

}  // namespace

std::string unit_of_weight(NeuronModel target) {
  switch (target) {
    case NeuronModel::iaf_psc_delta:
      return "mV";
    case NeuronModel::iaf_psc_exp:
      return "pA";
    default:
      return "1";
  }
}

void check_delay(const std::string& what, TimeNs delay, TimeNs resolution, const Location& where) {
  if (delay < resolution) {
    throw ConfigurationError(
        where, with_code(Code::delay, "{} {} is below the resolution {}; write at least {}", what,
                         format_time(delay), format_time(resolution), format_time(resolution)));
  }
  check_on_grid(what, delay, resolution, where);
}

void check_buffer(const std::string& what, TimeNs delay, TimeNs resolution, std::uint32_t wide,
                  const char* members, const Location& where) {
  const auto steps = static_cast<std::uint64_t>(delay / resolution);
  if (steps > kMostBufferEntries / wide) {
    throw ConfigurationError(
        where,
        with_code(Code::delay,
                  "{} {} is {} steps of {}{}, too much to buffer; write a shorter delay or "
                  "a coarser resolution{}",
                  what, format_time(delay), steps, format_time(resolution),
                  wide == 1 ? "" : fmt::format(" for each of {} {}", wide, members), kElsewhere));
  }
}

std::uint32_t read_index(const std::string& file, const std::string& what, const YAML::Node& node,
                         const NetworkPopulation& population) {
  const std::string text = scalar(file, what, node);
  const std::uint64_t largest = population.size - 1;
  std::uint64_t value = 0;
  const bool digits = text.find_first_not_of("0123456789") == std::string::npos && text.size() < 11;
  if (digits) {
    value = std::stoull(text);
  }
  if (!digits || value > largest) {
    throw ConfigurationError(
        place(file, node),
        with_code(Code::network,
                  "{}: '{}' is not a member of '{}'; write a whole number from 0 to {}", what, text,
                  population.name, largest));
  }
  return static_cast<std::uint32_t>(value);
}

std::size_t find_population(const NetworkFile& network, const std::string& name,
                            const Location& where, const std::string& what) {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < network.populations.size(); ++i) {
    if (network.populations[i].name == name) {
      return i;
    }
    names.push_back(network.populations[i].name);
  }
  throw ConfigurationError(where, with_code(Code::unknown_node, "{}: unknown population '{}'{}",
                                            what, name, did_you_mean(name, names)));
}

NetworkProjection read_connection(const NetworkFile& network, std::size_t index,
                                  const YAML::Node& node, const NetworkWeightLoader& load_weights) {
  const Section section(network.path, fmt::format("connection {}", index + 1), node,
                        {"from", "to", "rule", "weight", "delay", "pairs", "plasticity"});
  NetworkProjection projection;
  projection.where = section.where();
  projection.from = find_population(network, section.text("from", "input"), section.where("from"),
                                    section.what());
  projection.to =
      find_population(network, section.text("to", "relay"), section.where("to"), section.what());
  const Ends ends{network.populations[projection.from], network.populations[projection.to]};
  check_target(section, ends);
  projection.delay = read_delay(section, ends, network.resolution);
  projection.rule = is_table(section) ? "table" : section.text("rule", "one_to_one");
  group_by_source(apply_rule(projection.rule, section, ends, load_weights), ends.from.size,
                  projection);
  if (section.has("plasticity")) {
    projection.plasticity =
        read_plasticity(network, projection, section.what(), section.at("plasticity", ""));
  }
  return projection;
}

}  // namespace spikeloop::yaml_text
