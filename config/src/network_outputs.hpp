// What leaves a network: `output`, `potential`, `rates` and `record`.
#pragma once

#include "spikeloop/config/network_file.hpp"
#include "yaml_section.hpp"

namespace spikeloop::yaml_text {

/// Reads the four keys into `network`, whose populations are there.
/// @throws ConfigurationError: unknown population, one named twice, one that has no spikes, no
/// potential or no rate, a member that is not there, nothing that leaves.
void read_outputs(const Section& file, NetworkFile& network);

}  // namespace spikeloop::yaml_text
