// `spikeloop-network --check FILE`: what a network file says, as tables.
#pragma once

#include <string>

#include "spikeloop/config/network_file.hpp"

namespace spikeloop {

/// Resolution, ports, a line a population and a line a connection.
std::string describe(const NetworkFile& network);

}  // namespace spikeloop
