// What is wrong with an experiment file, with the lines that it is about.
#pragma once

#include <string>
#include <vector>

#include "spikeloop/experiment/experiment.hpp"

namespace spikeloop::app {

/// "error: TEXT", the line of the file, and a caret below the place.
std::string text_of(const char* kind, const Diagnostic& diagnostic);

/// Prints the first 20. Returns the exit code; 0 when all are code that was not run (--no-code).
int print_diagnostics(const std::string& file, const Diagnostics& diagnostics);

}  // namespace spikeloop::app
