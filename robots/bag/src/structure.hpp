// rosbag's reader trusts the lengths and offsets in a bag, and a damaged one would end the process.
#pragma once

#include <string>

namespace spikeloop::bag {

/// Follows all records of a bag of format 2.0, and all offsets of its index; of a compressed chunk
/// as far as one can without unpacking it. False: there is no index, as the recording was not
/// ended. @throws std::runtime_error when something leads outside.
bool check_structure(const std::string& path);

}  // namespace spikeloop::bag
