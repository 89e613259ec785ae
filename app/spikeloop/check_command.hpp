// Why a .music file is not run.
#pragma once

#include <string>

#include "spikeloop/launch/check.hpp"

namespace spikeloop::app {

/// @throws ConfigurationError for a file in Python, which is part of an experiment.
void refuse_script(const std::string& file);

/// Prints the first error of a file that is not run, or not exported. Returns the exit code.
int refuse(const Diagnostics& diagnostics, const std::string& file);

}  // namespace spikeloop::app
