// `spikeloop fit`: decoding weights by regression.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>

namespace spikeloop::app {

void add_fit_command(CLI::App& app, std::function<int()>& action);

}  // namespace spikeloop::app
