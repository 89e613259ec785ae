// Encoders of changes have two output channels an input: one for up, one for down.
#pragma once

#include <cstdint>
#include <vector>

#include "spikeloop/core/node.hpp"

namespace spikeloop {

/// How long after a change the spike follows that tells of it: a spike is later than its cause, and
/// no stamp of ours lies less than 1 us after the begin of an interval (docs/architecture.md).
inline constexpr TimeNs kReaction = 1'000;  // ns

/// Ports `in` (signal) and `out` (spikes).
std::vector<PortDescription> paired_channel_ports();
/// @throws ConfigurationError with both widths unless `out` is twice as wide as `in`.
void require_paired_channels(const NodeSetup& setup);

/// Channel 2d tells that input d went up, 2d+1 that it went down.
inline std::int32_t paired_channel(std::size_t input, bool up) {
  return static_cast<std::int32_t>(2 * input + (up ? 0 : 1));
}

}  // namespace spikeloop
