// The lines of `connections` in an experiment file.
#pragma once

#include <string>
#include <vector>

#include "spikeloop/config/experiment_file.hpp"

namespace spikeloop::experiment_text {

/// Appends the arrows of "a -> b.in [2] -> c [3, delay 5 ms]"; `where` is where the text begins.
/// @throws ConfigurationError at the place of what cannot be read.
void read_connections(const std::string& text, const Location& where,
                      std::vector<ExperimentConnection>& connections);

}  // namespace spikeloop::experiment_text
