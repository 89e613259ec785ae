// Networks from a Python function: `network: brain.py:make`. The function runs in a Python of its
// own
// (/usr/bin/python3, or the one that $PYTHON names), which leaves a network file and weights in a
// folder that is gone when they have been read; no program links Python for it.
#pragma once

#include <string>

#include "spikeloop/config/network_file.hpp"

namespace spikeloop {

/// The file of "brain.py:make"; any other text as it is.
std::string network_source(const std::string& written);

/// Whether `written` is FILE.py or FILE.py:FUNCTION.
bool is_network_script(const std::string& written);

/// The network that the function returns; `make` where none is named. What it prints goes to the
/// error stream, its warnings to the log.
/// @throws FileError when there is no such file; TransportError without a Python;
/// ConfigurationError with the file, the line and Python's traceback when it fails, and as
/// parse_network.
NetworkFile run_network_script(const std::string& written);

}  // namespace spikeloop
