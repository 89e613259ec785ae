// Puts the spikes of a tick in order of time, those of one time in order of channel.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "spikeloop/core/signal.hpp"

namespace spikeloop {

/// A radix sort: an encoder's spikes of a tick are millions, and comparing them took four fifths of
/// a whole experiment's time. Keeps its memory from tick to tick.
class SpikeSorter {
 public:
  /// The same order as std::sort with spike_before.
  void sort(std::vector<Spike>& spikes);

 private:
  bool order(std::span<Spike> spikes, std::span<Spike> other);
  bool order_by_channel(std::span<Spike> spikes, std::span<Spike> other);
  template <typename Digit>
  void deal(std::span<const Spike> from, std::span<Spike> to, int bits, Digit&& digit);

  std::vector<Spike> other_;
  std::vector<std::size_t> counts_;
};

}  // namespace spikeloop
