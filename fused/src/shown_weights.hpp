// The weights of synapses that learn, as the live view shows them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "spikeloop/core/graph.hpp"
#include "spikeloop/live/feed.hpp"

namespace spikeloop::fused {

class ShownWeights {
 public:
  /// Adds a channel "/NODE/FROM.TO" for each learning projection of a graph, which must outlive it.
  ShownWeights(live::Feed& feed, const Graph& graph);

  /// Sends the present weights, of a long projection evenly chosen ones.
  void publish(TimeNs time);

 private:
  live::Feed& feed_;
  const Graph& graph_;
  std::vector<std::uint32_t> channels_;  ///< in the order of Graph::learning_weights()
  std::vector<double> chosen_;
  std::vector<std::byte> message_;
};

}  // namespace spikeloop::fused
