// Puts the spikes of a tick in order of time, those of one time in order of channel.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "spikeloop/core/signal.hpp"

namespace spikeloop {

/// A radix sort: an encoder's spikes of a tick are millions, and comparing them took four fifths of
/// a whole experiment's time. The leading bits of the times bring nearly all spikes to their
/// places; what shares them is sorted by itself. Keeps its memory from tick to tick.
class SpikeSorter {
 public:
  /// The same order as std::sort with spike_before.
  void sort(std::vector<Spike>& spikes);

 private:
  template <typename Key>
  std::span<Spike> by_key(std::span<Spike> spikes, std::span<Spike> other, int bits, Key&& key);
  template <typename Key>
  void finish_groups(std::span<Spike> spikes, std::span<Spike> other, Key&& key);
  void sort_group(std::span<Spike> spikes, std::span<Spike> other);

  std::vector<Spike> other_;
  std::vector<std::size_t> counts_;
};

}  // namespace spikeloop
