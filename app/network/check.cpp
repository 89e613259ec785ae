#include "check.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace spikeloop {

namespace {

std::string port_of(const NetworkFile& network, std::size_t population) {
  if (network.populations[population].model == NeuronModel::input) {
    return "in";
  }
  const bool leaves =
      std::find(network.output.begin(), network.output.end(), population) != network.output.end();
  return leaves ? "out" : "-";
}

std::string weight_range(const NetworkProjection& projection, NeuronModel model) {
  if (projection.weight.empty()) {
    return "-";
  }
  const auto [low, high] = std::minmax_element(projection.weight.begin(), projection.weight.end());
  const char* unit = model == NeuronModel::iaf_psc_delta ? " mV"
                     : model == NeuronModel::iaf_psc_exp ? " pA"
                                                         : "";
  return *low == *high ? fmt::format("{:g}{}", *low, unit)
                       : fmt::format("{:g}..{:g}{}", *low, *high, unit);
}

}  // namespace

std::string describe(const NetworkFile& network) {
  std::string text = fmt::format(
      "{}: resolution {}, port in [{}], port out [{}]\n\n{:<16} {:<14} {:>10}  {}\n", network.path,
      network.resolution == 0 ? "off" : format_time(network.resolution), network.input_width(),
      network.output_width(), "population", "model", "size", "port");
  for (std::size_t i = 0; i < network.populations.size(); ++i) {
    const NetworkPopulation& population = network.populations[i];
    text += fmt::format("{:<16} {:<14} {:>10}  {}\n", population.name, model_name(population.model),
                        population.size, port_of(network, i));
  }
  text += fmt::format("\n{:<16} {:<16} {:<14} {:>10} {:>10}  {}\n", "from", "to", "rule",
                      "synapses", "delay", "weight");
  for (const NetworkProjection& projection : network.projections) {
    const NetworkPopulation& to = network.populations[projection.to];
    text += fmt::format("{:<16} {:<16} {:<14} {:>10} {:>10}  {}\n",
                        network.populations[projection.from].name, to.name, projection.rule,
                        projection.target.size(), format_time(projection.delay),
                        weight_range(projection, to.model));
  }
  return text;
}

}  // namespace spikeloop
