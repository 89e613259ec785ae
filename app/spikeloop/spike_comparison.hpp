// Whether two runs have the same spikes.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "spikeloop/core/time.hpp"

namespace spikeloop::app {

struct SpikeComparison {
  std::uint64_t spikes = 0;  ///< of the first run
  std::string difference;    ///< the earliest one, in a sentence; empty: there is none
};

/// Compares all recorded spike trains of these nodes up to `until`, in the order in which the loop
/// saw them. @throws FileError when a recording cannot be read.
SpikeComparison compare_spikes(const std::string& run, const std::string& replay,
                               const std::vector<std::string>& nodes, TimeNs until);

}  // namespace spikeloop::app
