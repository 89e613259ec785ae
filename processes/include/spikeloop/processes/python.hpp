// Our programs and our Python package, and the Python that runs it.
#pragma once

#include <string>
#include <vector>

namespace spikeloop {

/// The folder of the running program, which has our other programs, too.
std::string own_directory();

/// The variable PYTHON, else /usr/bin/python3.
std::string python_name();

/// The folder of the package `spikeloop`: installed, in the build tree, or in the sources.
std::string python_package();

/// PYTHONPATH with the package, behind what the user has put there.
std::string python_path();

/// Replaces this process by the program words[0], which is searched in PATH.
/// @return errno, when it cannot be started
int become_program(std::vector<std::string> words);

}  // namespace spikeloop
