// What programs of one job share outside of MUSIC: ROS topics and ZeroMQ addresses.
#pragma once

#include "spikeloop/launch/check.hpp"

namespace spikeloop::launch {

/// Two programs that write to one topic or address, and a job that hears itself.
Findings check_outside(const MusicFile& file, bool strict);

}  // namespace spikeloop::launch
