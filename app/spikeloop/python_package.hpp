// Modules of our Python package as subcommands.
#pragma once

#include <string>
#include <vector>

namespace spikeloop::app {

/// The file of python_name(); empty: there is none.
std::string python_program();

/// Python takes this process over with a module of the package: signals and the exit code are its
/// own. `purpose` and `packages` are for whoever has no Python: "which draws",
/// "python3-matplotlib".
/// @throws TransportError without a Python, FileError when it does not start.
[[noreturn]] void become_python(const std::string& module,
                                const std::vector<std::string>& arguments,
                                const std::string& purpose, const std::string& packages);

}  // namespace spikeloop::app
