// The log of roscpp.
#pragma once

namespace spikeloop::ros1 {

/// Sends what roscpp logs to Spikeloop's log instead of the terminal: warnings and errors as
/// warnings, each kind once, everything else as debug messages. Call after ros::init.
void redirect_roscpp_log();

}  // namespace spikeloop::ros1
