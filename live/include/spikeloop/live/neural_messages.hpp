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

/// Both append to `message`, which they empty first.
void write_spikes(std::span<const std::int64_t> times, std::span<const std::uint32_t> channels,
                  std::vector<std::byte>& message);
void write_signal(std::span<const double> values, std::vector<std::byte>& message);

}  // namespace spikeloop::live
