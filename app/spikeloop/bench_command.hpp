// `spikeloop bench`: the measurements of Weidel et al. 2016, made with this Spikeloop.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>

namespace spikeloop::app {

/// Adds the subcommand. When it was given, `action` is what is to be done: it returns the exit
/// code.
void add_bench_command(CLI::App& app, std::function<int()>& action);

}  // namespace spikeloop::app
