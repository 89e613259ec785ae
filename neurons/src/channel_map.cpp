#include <algorithm>

#include "simulation.hpp"

namespace spikeloop::neurons {

ChannelMap::ChannelMap(const NetworkFile& network)
    : output_base_(network.populations.size(), -1), recorded_(network.populations.size(), 0) {
  std::uint32_t end = 0;
  for (std::size_t i = 0; i < network.populations.size(); ++i) {
    if (network.populations[i].model == NeuronModel::input) {
      end += network.populations[i].size;
      input_end_.push_back(end);
      input_population_.push_back(i);
    }
  }
  std::int32_t base = 0;
  for (const std::size_t population : network.output) {
    output_base_[population] = base;
    base += static_cast<std::int32_t>(network.populations[population].size);
  }
  std::size_t lists = 0;
  for (const NetworkRecord& record : network.record) {
    recorded_[record.population] = record.spikes ? ++lists : 0;
  }
}

ChannelMap::Member ChannelMap::input(std::int32_t channel) const {
  const auto wanted = static_cast<std::uint32_t>(channel);
  const auto k = static_cast<std::size_t>(
      std::upper_bound(input_end_.begin(), input_end_.end(), wanted) - input_end_.begin());
  return {input_population_[k], wanted - (k == 0 ? 0 : input_end_[k - 1])};
}

std::vector<std::vector<std::size_t>> outgoing(const NetworkFile& network) {
  std::vector<std::vector<std::size_t>> lists(network.populations.size());
  for (std::size_t i = 0; i < network.projections.size(); ++i) {
    const NeuronModel from = network.populations[network.projections[i].from].model;
    if (!is_current(from) && !is_rate(from)) {
      lists[network.projections[i].from].push_back(i);
    }
  }
  return lists;
}

}  // namespace spikeloop::neurons
