#include "check.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace spikeloop {

namespace {

std::string port_of(const NetworkFile& network, std::size_t population) {
  if (network.populations[population].model == NeuronModel::input) {
    return "in";
  }
  if (network.populations[population].model == NeuronModel::signal_input) {
    return "signal";
  }
  std::string ports;
  const auto add = [&](bool leaves, const std::string& port) {
    ports += leaves ? (ports.empty() ? "" : ", ") + port : "";
  };
  const auto in = [&](const auto& list) {
    return std::find(list.begin(), list.end(), population) != list.end();
  };
  add(in(network.output), "out");
  add(in(network.potential), "potential");
  add(in(network.rates), "rates");
  for (const NetworkRecord& record : network.record) {
    const std::string& name = network.populations[population].name;
    add(record.population == population && record.spikes, name + "_spikes");
    add(record.population == population && !record.potential.empty(), name + "_V_m");
  }
  return ports.empty() ? "-" : ports;
}

std::string weight_range(const NetworkProjection& projection, NeuronModel from, NeuronModel model) {
  if (projection.weight.empty()) {
    return "-";
  }
  const auto [low, high] = std::minmax_element(projection.weight.begin(), projection.weight.end());
  const bool current = is_current(from);
  const bool plain = is_rate(model) || (current && from != NeuronModel::signal_input);
  const char* unit = plain                                          ? ""
                     : current || model == NeuronModel::iaf_psc_exp ? " pA"
                     : model == NeuronModel::iaf_psc_delta          ? " mV"
                                                                    : "";
  return *low == *high ? fmt::format("{:g}{}", *low, unit)
                       : fmt::format("{:g}..{:g}{}", *low, *high, unit);
}

}  // namespace

std::string describe(const NetworkFile& network) {
  std::string text = fmt::format("{}: resolution {}, port in [{}], port out [{}]", network.path,
                                 network.resolution == 0 ? "off" : format_time(network.resolution),
                                 network.input_width(), network.output_width());
  if (network.signal_width() != 0) {
    text += fmt::format(", port signal [{}]", network.signal_width());
  }
  if (network.potential_width() != 0) {
    text += fmt::format(", port potential [{}]", network.potential_width());
  }
  if (network.rates_width() != 0) {
    text += fmt::format(", port rates [{}]", network.rates_width());
  }
  std::size_t wide = 14;
  for (const NetworkPopulation& population : network.populations) {
    wide = std::max(wide, model_name(population.model).size());
  }
  text +=
      fmt::format("\n\n{:<16} {:<{}} {:>10}  {}\n", "population", "model", wide, "size", "port");
  for (std::size_t i = 0; i < network.populations.size(); ++i) {
    const NetworkPopulation& population = network.populations[i];
    text += fmt::format("{:<16} {:<{}} {:>10}  {}\n", population.name, model_name(population.model),
                        wide, population.size, port_of(network, i));
  }
  text += fmt::format("\n{:<16} {:<16} {:<14} {:>10} {:>10}  {}\n", "from", "to", "rule",
                      "synapses", "delay", "weight");
  for (const NetworkProjection& projection : network.projections) {
    const NetworkPopulation& from = network.populations[projection.from];
    const NetworkPopulation& to = network.populations[projection.to];
    text += fmt::format("{:<16} {:<16} {:<14} {:>10} {:>10}  {}\n", from.name, to.name,
                        projection.rule, projection.target.size(),
                        projection.delay == 0 ? "-" : format_time(projection.delay),
                        weight_range(projection, from.model, to.model));
    if (projection.plasticity) {
      text.insert(text.size() - 1, fmt::format(", {}", rule_name(projection.plasticity->rule)));
    }
  }
  return text;
}

}  // namespace spikeloop
