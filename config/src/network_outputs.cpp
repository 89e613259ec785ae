#include "network_outputs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>

#include "network_connections.hpp"
#include "network_populations.hpp"
#include "spikeloop/core/code.hpp"

namespace spikeloop::yaml_text {

namespace {

void check_spikes(const NetworkPopulation& population, const std::string& what,
                  const Location& where) {
  if (population.model == NeuronModel::input) {
    throw ConfigurationError(where, with_code(Code::network,
                                              "{}: '{}' is an input; connect it to a repeater "
                                              "and write the repeater's name",
                                              what, population.name));
  }
  if (is_current(population.model) || is_rate(population.model)) {
    throw ConfigurationError(
        where, with_code(Code::network,
                         "{}: '{}' is a {}, which has no spikes; write a population of neurons, "
                         "repeaters or a poisson",
                         what, population.name, model_name(population.model)));
  }
}

void check_potential(const NetworkPopulation& population, const std::string& what,
                     const Location& where) {
  if (!has_membrane(population.model)) {
    throw ConfigurationError(
        where, with_code(Code::network,
                         "{}: '{}' is a {}, which has no membrane potential; write a population "
                         "of model iaf_psc_delta or iaf_psc_exp",
                         what, population.name, model_name(population.model)));
  }
}

void check_rate(const NetworkPopulation& population, const std::string& what,
                const Location& where) {
  if (!is_rate(population.model)) {
    throw ConfigurationError(
        where, with_code(Code::network,
                         "{}: '{}' is of model {}, which has no rate; write a population of model "
                         "lin_rate_ipn, threshold_lin_rate_ipn or sigmoid_rate_ipn",
                         what, population.name, model_name(population.model)));
  }
}

template <typename Check>
std::vector<std::size_t> read_list(const Section& file, const char* key, const NetworkFile& network,
                                   Check&& check) {
  const YAML::Node& list = file.at(key, "[name of a population]");
  const std::string what = fmt::format("key '{}'", key);
  if (!list.IsSequence() || list.size() == 0) {
    throw ConfigurationError(
        place(network.path, list),
        with_code(Code::wrong_shape, "{}: expected a list of populations; write  {}: [name]", what,
                  key));
  }
  std::vector<std::size_t> result;
  for (const auto& entry : list) {
    const std::string name = scalar(network.path, key, entry);
    const Location where = place(network.path, entry);
    const std::size_t index = find_population(network, name, where, what);
    check(network.populations[index], what, where);
    if (std::find(result.begin(), result.end(), index) != result.end()) {
      throw ConfigurationError(
          where, with_code(Code::duplicate_key, "{}: population '{}' is named twice; write it once",
                           what, name));
    }
    result.push_back(index);
  }
  return result;
}

// `all`, or a list of members.
std::vector<std::uint32_t> read_members(const Section& section,
                                        const NetworkPopulation& population) {
  const YAML::Node& list = section.at("V_m", "all");
  std::vector<std::uint32_t> members;
  if (list.IsScalar() && list.Scalar() == "all") {
    members.resize(population.size);
    for (std::uint32_t i = 0; i < population.size; ++i) {
      members[i] = i;
    }
    return members;
  }
  if (!list.IsSequence() || list.size() == 0) {
    throw ConfigurationError(
        section.where("V_m"),
        with_code(Code::wrong_shape,
                  "{}: V_m is not a list of members; write  V_m: all  or  V_m: [0]",
                  section.what()));
  }
  for (const auto& entry : list) {
    members.push_back(read_index(section.file(), section.what() + ": V_m", entry, population));
  }
  return members;
}

NetworkRecord read_record(const NetworkFile& network, const Section& list,
                          const std::string& name) {
  const std::size_t index = find_population(network, name, list.where_name(name), "key 'record'");
  const NetworkPopulation& population = network.populations[index];
  if (!std::ranges::all_of(name,
                           [](unsigned char c) { return std::isalnum(c) != 0 || c == '_'; })) {
    throw ConfigurationError(
        list.where_name(name),
        with_code(Code::invalid_name,
                  "key 'record': '{}' names ports, so it is made of letters, digits and '_'; give "
                  "the population another name",
                  name));
  }
  const Section section(network.path, fmt::format("record of '{}'", name),
                        list.at(name, "{spikes: true}"), {"spikes", "V_m", "interval"});
  NetworkRecord record;
  record.population = index;
  record.where = section.where();
  if (section.has("spikes")) {
    const std::string text = section.text("spikes", "true");
    if (text != "true" && text != "false") {
      throw ConfigurationError(section.where("spikes"),
                               with_code(Code::unknown_choice,
                                         "{}: spikes '{}' is neither true nor false; write one "
                                         "of them",
                                         section.what(), text));
    }
    record.spikes = text == "true";
  }
  if (record.spikes) {
    check_spikes(population, "key 'record'", section.where("spikes"));
  }
  if (section.has("V_m")) {
    check_potential(population, "key 'record'", section.where("V_m"));
    record.potential = read_members(section, population);
  }
  if (section.has("interval")) {
    if (record.potential.empty()) {
      throw ConfigurationError(section.where("interval"),
                               with_code(Code::network,
                                         "{}: 'interval' is that of V_m, which is not there; "
                                         "write  V_m: all, too",
                                         section.what()));
    }
    record.interval = section.time("interval", "10 ms");
  }
  if (!record.spikes && record.potential.empty()) {
    throw ConfigurationError(
        section.where(),
        with_code(Code::network, "{} has nothing to record; write  spikes: true  or  V_m: all",
                  section.what()));
  }
  return record;
}

}  // namespace

void read_outputs(const Section& file, NetworkFile& network) {
  if (file.has("potential")) {
    network.potential = read_list(file, "potential", network, check_potential);
  }
  if (file.has("rates")) {
    network.rates = read_list(file, "rates", network, check_rate);
  }
  if (file.has("record")) {
    const Section list(network.path, "key 'record'", file.at("record", ""), {});
    for (const std::string& name : list.keys()) {
      network.record.push_back(read_record(network, list, name));
    }
  }
  const bool others =
      !network.potential.empty() || !network.rates.empty() || !network.record.empty();
  if (file.has("output") || !others) {
    network.output = read_list(file, "output", network, check_spikes);
  }
}

}  // namespace spikeloop::yaml_text
