// Spikes and signals as messages: CDR, little endian, as those of ROS 2.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "spikeloop/live/feed.hpp"

namespace spikeloop::live {

/// Of spikeloop/msg/Spikes: times in ns of simulated time, and for each its channel, from 0.
Channel spike_channel(const std::string& topic);
/// Of spikeloop/msg/Signal: one value per channel; NaN: there is no value yet.
Channel signal_channel(const std::string& topic);
/// Of spikeloop/msg/Weights: how many synapses of a projection learn, and the weights of evenly
/// chosen ones, weight k being that of synapse k * synapses / (number of weights).
Channel weights_channel(const std::string& topic);

/// All append to `message`, which they empty first.
void write_spikes(std::span<const std::int64_t> times, std::span<const std::uint32_t> channels,
                  std::vector<std::byte>& message);
void write_signal(std::span<const double> values, std::vector<std::byte>& message);
void write_weights(std::uint64_t synapses, std::span<const double> weights,
                   std::vector<std::byte>& message);

}  // namespace spikeloop::live
