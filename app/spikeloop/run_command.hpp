// `spikeloop run FILE.music`
#pragma once

#include <CLI/CLI.hpp>
#include <functional>

#include "spikeloop/topics/arguments.hpp"

namespace spikeloop::app {

/// Adds the subcommand. When it was given, `action` is what is to be done: it returns the exit
/// code.
/// @param line what the command line has for ROS
void add_run_command(CLI::App& app, const topics::CommandLine& line, std::function<int()>& action);

}  // namespace spikeloop::app
