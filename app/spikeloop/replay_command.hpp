// `spikeloop replay RUN`
#pragma once

#include <CLI/CLI.hpp>
#include <functional>

namespace spikeloop::app {

/// As add_check_command().
void add_replay_command(CLI::App& app, std::function<int()>& action);

}  // namespace spikeloop::app
