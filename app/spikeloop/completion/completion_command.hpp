// `spikeloop completion SHELL`: a script that completes commands, options, files and node classes.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>

namespace spikeloop::app {

/// Adds the subcommand, which reads all commands of `app` when it is given: also later ones.
void add_completion_command(CLI::App& app, std::function<int()>& action);

}  // namespace spikeloop::app
