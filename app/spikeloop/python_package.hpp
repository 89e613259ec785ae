// Our Python package, and the Python that runs it.
#pragma once

#include <string>

namespace spikeloop::app {

/// What stands in PYTHON, else /usr/bin/python3; empty: there is none.
std::string python_program();

/// Where the package is, from the program's own place: built or installed.
std::string python_package();

}  // namespace spikeloop::app
