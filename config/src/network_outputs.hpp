// What leaves a network: `output`, `potential` and `record`.
#pragma once

#include "spikeloop/config/network_file.hpp"
#include "yaml_section.hpp"

namespace spikeloop::yaml_text {

/// Reads the three keys into `network`, whose populations are there.
/// @throws ConfigurationError: unknown population, one named twice, one that has no spikes or no
/// potential, a member that is not there, nothing that leaves.
void read_outputs(const Section& file, NetworkFile& network);

}  // namespace spikeloop::yaml_text
