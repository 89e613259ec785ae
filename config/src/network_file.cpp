#include "spikeloop/config/network_file.hpp"
#include "spikeloop/core/code.hpp"
#include "spikeloop/core/file.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "network_connections.hpp"
#include "network_outputs.hpp"
#include "network_populations.hpp"
#include "spikeloop/config/network_script.hpp"
#include "spikeloop/config/weight_file.hpp"
#include "yaml_section.hpp"

namespace spikeloop {

namespace {

using yaml_text::kMostNeurons;
using yaml_text::Section;

constexpr TimeNs kDefaultResolution = 100'000;  // NEST's 0.1 ms

TimeNs read_resolution(const Section& section) {
  if (!section.has("resolution")) {
    return kDefaultResolution;
  }
  return section.text("resolution", "0.1 ms") == "off" ? 0 : section.time("resolution", "0.1 ms");
}

void check_total(const NetworkFile& network, const Section& populations) {
  double total = 0;
  for (const auto& population : network.populations) {
    total += population.size;
  }
  if (total > kMostNeurons) {
    throw ConfigurationError(
        populations.where(),
        with_code(Code::out_of_bounds,
                  "the populations have {:.0f} members together, more than the {:.0f} that this "
                  "network takes; larger models belong in NEST, NEURON or Brian2",
                  total, kMostNeurons));
  }
}

// Of the last projection: learned weights of two would come to lie in one file.
void check_save(const NetworkFile& network) {
  const auto saved = [](const NetworkProjection& projection) {
    return projection.plasticity ? projection.plasticity->save : std::string();
  };
  const NetworkProjection& last = network.projections.back();
  for (std::size_t i = 0; i + 1 < network.projections.size(); ++i) {
    if (!saved(last).empty() && saved(last) == saved(network.projections[i])) {
      throw ConfigurationError(
          last.plasticity->where,
          with_code(Code::network,
                    "connections {} and {} save their weights as '{}'; write another name for one",
                    i + 1, network.projections.size(), saved(last)));
    }
  }
}

std::uint32_t width_of(const NetworkFile& network, NeuronModel model) {
  std::uint32_t width = 0;
  for (const auto& population : network.populations) {
    width += population.model == model ? population.size : 0;
  }
  return width;
}

std::uint32_t width_of(const NetworkFile& network, const std::vector<std::size_t>& list) {
  std::uint32_t width = 0;
  for (const std::size_t index : list) {
    width += network.populations[index].size;
  }
  return width;
}

}  // namespace

std::uint32_t NetworkFile::input_width() const {
  return width_of(*this, NeuronModel::input);
}

std::uint32_t NetworkFile::signal_width() const {
  return width_of(*this, NeuronModel::signal_input);
}

std::uint32_t NetworkFile::output_width() const {
  return width_of(*this, output);
}

std::uint32_t NetworkFile::potential_width() const {
  return width_of(*this, potential);
}

std::uint32_t NetworkFile::rates_width() const {
  return width_of(*this, rates);
}

void NetworkFile::check_grid(TimeNs time) const {
  if (resolution != 0 && time % resolution != 0) {
    const TimeNs below = time / resolution * resolution;
    throw ConfigurationError(
        resolution_where, with_code(Code::off_grid,
                                    "the tick {} is not a whole number of the network's resolution "
                                    "{}; write a tick of {} or another resolution",
                                    format_time(time), format_time(resolution),
                                    format_time(below == 0 ? resolution : below)));
  }
}

void NetworkFile::check_tick(TimeNs tick) const {
  check_grid(tick);
  for (const NetworkRecord& entry : record) {
    if (entry.interval % tick != 0) {
      throw ConfigurationError(
          entry.where,
          with_code(Code::off_grid,
                    "record of '{}': the interval {} is not a whole number of ticks of {}; write "
                    "{}, or another tick",
                    populations[entry.population].name, format_time(entry.interval),
                    format_time(tick), format_time((entry.interval / tick + 1) * tick)));
    }
  }
}

NetworkFile parse_network(const std::string& text, const std::string& path,
                          const NetworkWeightLoader& load_weights) {
  const YAML::Node root = yaml_text::load(text, path, "network");
  const Section file(
      path, "network file", root,
      {"resolution", "populations", "connections", "output", "potential", "rates", "record"});
  NetworkFile network;
  network.path = path;
  network.resolution = read_resolution(file);
  network.resolution_where =
      file.has("resolution") ? file.where("resolution") : Location{path, 0, 0};
  const Section populations(path, "key 'populations'",
                            file.at("populations", "{relay: {model: repeater, size: 1}}"), {});
  for (const std::string& name : populations.keys()) {
    network.populations.push_back(yaml_text::read_population(network, populations, name));
  }
  check_total(network, populations);
  if (file.has("connections")) {
    const YAML::Node& list = file.at("connections", "");
    if (!list.IsSequence()) {
      throw ConfigurationError(
          file.where("connections"),
          with_code(Code::wrong_shape,
                    "key 'connections': expected a list; write lines of  - {from: a, "
                    "to: b, rule: one_to_one, weight: 1, delay: 1 ms}"));
    }
    for (std::size_t i = 0; i < list.size(); ++i) {
      network.projections.push_back(yaml_text::read_connection(network, i, list[i], load_weights));
      check_save(network);
    }
  }
  yaml_text::read_outputs(file, network);
  return network;
}

NetworkFile read_network_file(const std::string& path) {
  if (is_network_script(path)) {
    NetworkScript script(path);
    return script.network(resolve(script.parameters(), {}, {}));
  }
  constexpr std::uint64_t kMostBytes = 100'000'000;
  return parse_network(
      read_file(path, "network file", kMostBytes), path,
      [](const std::string& weights) { return read_weights(weights, {.short_forms = false}); });
}

}  // namespace spikeloop
