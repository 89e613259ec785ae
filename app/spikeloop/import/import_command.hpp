// `spikeloop import`: a .music file as an experiment file.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>

namespace spikeloop::app {

/// Adds the subcommand. When it was given, `action` is what is to be done: it returns the exit
/// code.
void add_import_command(CLI::App& app, std::function<int()>& action);

}  // namespace spikeloop::app
