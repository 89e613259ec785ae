// Random spikes for tests of decoders, which can be handed over at any tick.
#pragma once

#include <algorithm>
#include <random>
#include <vector>

#include "harness.hpp"

namespace spikeloop::testing {

/// `count` spikes on `channels` channels in (0, end], in order; on a grid, so that many share a
/// time.
inline std::vector<Spike> random_spikes(std::size_t count, std::int32_t channels, TimeNs end,
                                        unsigned seed = 5, TimeNs grid = 100'000) {
  std::mt19937_64 generator(seed);
  std::uniform_int_distribution<TimeNs> when(1, end / grid);
  std::uniform_int_distribution<std::int32_t> channel(0, channels - 1);
  std::vector<Spike> spikes;
  for (std::size_t i = 0; i < count; ++i) {
    spikes.push_back(make_spike(when(generator) * grid, channel(generator)));
  }
  std::sort(spikes.begin(), spikes.end(), spike_before);
  return spikes;
}

/// Advances to `end`, handing each spike over in its interval; calls `after()` after every tick.
template <typename After>
void play(NodeHarness& node, const std::vector<Spike>& spikes, TimeNs end, TimeNs tick,
          After&& after) {
  auto next = spikes.begin();
  while (node.time() < end) {
    for (; next != spikes.end() && next->time_ns <= node.time() + tick; ++next) {
      node.add_spike(next->time_ns, next->channel);
    }
    node.step(tick);
    after();
  }
}

/// The outputs at every multiple of `every`, one after the other.
inline std::vector<std::vector<double>> outputs_at(NodeHarness& node,
                                                   const std::vector<Spike>& spikes, TimeNs end,
                                                   TimeNs tick, TimeNs every) {
  std::vector<std::vector<double>> outputs;
  play(node, spikes, end, tick, [&] {
    if (node.time() % every == 0) {
      outputs.push_back(node.revision() == 0 ? std::vector<double>{} : node.output());
    }
  });
  return outputs;
}

}  // namespace spikeloop::testing
