// The programs that come with `spikeloop`.
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

namespace spikeloop::app {

/// Those that are files; the others are links to them.
inline constexpr std::array<std::string_view, 8> kProgramFiles{
    "spikeloop",     "spikeloop-node",  "spikeloop-network", "spikeloop-ros",
    "spikeloop-zmq", "spikeloop-robot", "spikeloop-guard",   "spikeloop-live"};

/// All names, sorted.
std::vector<std::string> all_programs();

}  // namespace spikeloop::app
