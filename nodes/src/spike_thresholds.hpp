// What the integral of a neuron's rate must reach from one spike to the next: 1 for regular spikes,
// an exponentially distributed number of mean 1 for a Poisson process.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "large_array.hpp"
#include "spike_schedule.hpp"
#include "spikeloop/core/random.hpp"

namespace spikeloop {

class SpikeThresholds {
 public:
  /// For the channels of `schedule`, whose first thresholds it sets.
  SpikeThresholds(const NodeSetup& setup, bool poisson, SpikeSchedule& schedule);

  /// The thresholds after a spike of each of these channels.
  void operator()(std::span<const std::uint32_t> channels, std::span<double> next);

 private:
  RandomStream stream_;
  std::uint32_t first_;
  // Index of each channel's next draw; empty: regular spikes. It comes round after 49 days of
  // spikes at 1 kHz.
  LargeArray<std::uint32_t> draws_;
  std::vector<std::uint32_t> indices_;
};

}  // namespace spikeloop
