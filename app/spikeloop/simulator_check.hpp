// Whether the simulators of an experiment are installed.
#pragma once

#include <vector>

#include "spikeloop/experiment/experiment.hpp"

namespace spikeloop::app {

/// Adds a diagnostic for every node whose simulator the Python of scripts does not find. Looks for
/// the module, and does not import it.
void check_simulators(const experiment::Experiment& experiment, Diagnostics& diagnostics);

}  // namespace spikeloop::app
