// Cycles of connections, and the acceptable latencies that they ask for.
#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <vector>

#include "spikeloop/config/music_file.hpp"
#include "spikeloop/core/time.hpp"

namespace spikeloop::launch {

/// Indices into MusicFile::connections, in the order of the data.
using Cycle = std::vector<std::size_t>;

/// Every cycle that meets no application twice; parallel connections make cycles of their own.
/// Stops at 10000: such a file has other troubles.
std::vector<Cycle> find_cycles(const MusicFile& file);

struct Latencies {
  /// Acceptable latency of the spike inputs of each of our programs that has some: as written or,
  /// where nothing is written, as the cycles need it.
  std::map<std::string, TimeNs> by_label;
  std::vector<std::string> warnings;
};

/// Shares what a cycle needs equally among its hops into spike inputs of ours that nobody has
/// written an `accept_latency` for.
Latencies choose_latencies(const MusicFile& file);

}  // namespace spikeloop::launch
