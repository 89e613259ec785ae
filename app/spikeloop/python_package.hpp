// Our Python package, and the Python that runs it.
#pragma once

#include <string>
#include <vector>

namespace spikeloop::app {

/// The variable PYTHON, else /usr/bin/python3.
std::string python_name();

/// The file of that program; empty: there is none.
std::string python_program();

/// Where the package is, from the program's own place: built or installed.
std::string python_package();

/// Where the running program's file is; our other programs are beside it.
std::string programs_folder();

/// Python takes this process over with a module of the package: signals and the exit code are its
/// own. `purpose` and `packages` are for whoever has no Python: "which draws",
/// "python3-matplotlib".
/// @throws TransportError without a Python, FileError when it does not start.
[[noreturn]] void become_python(const std::string& module,
                                const std::vector<std::string>& arguments,
                                const std::string& purpose, const std::string& packages);

}  // namespace spikeloop::app
