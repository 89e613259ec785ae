// `spikeloop check FILE.music`
#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <string>

#include "spikeloop/launch/check.hpp"

namespace spikeloop::app {

/// Adds the subcommand. When it was given, `action` is what is to be done: it returns the exit
/// code.
void add_check_command(CLI::App& app, std::function<int()>& action);

/// Says why a file is not run, or exported: its first error. Returns the exit code.
int refuse(const launch::Findings& findings, const std::string& file);

}  // namespace spikeloop::app
