// The order of applications and the paths of data between them.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "spikeloop/config/music_file.hpp"

namespace spikeloop {

/// Labels with every receiver before its senders: MUSIC walks the sections in this order, and in
/// any other a spike waits one tick of wall time a hop.
///
/// Where the file leaves a choice, its order holds, so a file that is downstream-first already
/// stays as it is. A cycle is broken at the connections from inside the cycle into its first
/// application: the one listed first of those that are fed from outside the cycle; when none is,
/// the one listed first. Connections to unknown applications do not count.
std::vector<std::string> downstream_first(const MusicFile& file);

/// The same file with its sections in that order.
MusicFile order_downstream_first(MusicFile file);

/// A chain of connections from one application to another.
struct DataPath {
  std::vector<std::size_t>
      connections;  ///< indices into MusicFile::connections, in the data's order
  int continuous_hops = 0;
};

/// Whether the ports of a connection are continuous; a `.music` file does not say.
using IsContinuous = std::function<bool(const MusicConnection&)>;

/// The path with the fewest continuous hops, of those one with the fewest hops; nothing when
/// there is no path. From an application to itself: around the cycle.
std::optional<DataPath> data_path(const MusicFile& file, std::string_view from_app,
                                  std::string_view to_app, const IsContinuous& is_continuous);

/// Ticks of simulated time that data need on that path with acceptable latency 0: a continuous hop
/// shows the sender's value of the same time, but a relay can only send it on in its next tick. So
/// every continuous hop after the first costs one: max(0, continuous hops - 1).
std::optional<int> data_path_ticks(const MusicFile& file, std::string_view from_app,
                                   std::string_view to_app, const IsContinuous& is_continuous);

}  // namespace spikeloop
