// rosbag's reader trusts the lengths and offsets in a bag, and a damaged one would end the process.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace spikeloop::bag {

/// Where in a bag a message is: the order in which messages were recorded.
struct BagPosition {
  std::uint32_t seconds;
  std::uint32_t nanoseconds;
  std::uint64_t chunk;
  std::uint32_t offset;
};

struct BagStructure {
  bool has_index = true;  ///< false if the recording was not ended
  /// Messages of every connection, as indexed. Empty for formats before 2.0.
  std::map<std::uint32_t, std::vector<BagPosition>> positions;
};

/// Follows all records of a bag of format 2.0, and all offsets of its index; of a compressed chunk
/// as far as one can without unpacking it. @throws std::runtime_error when something leads outside.
BagStructure check_structure(const std::string& path);

}  // namespace spikeloop::bag
