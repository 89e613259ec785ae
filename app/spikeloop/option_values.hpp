// What stands behind the options of `spikeloop run`, read strictly.
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <string>
#include <vector>

#include "spikeloop/config/experiment_file.hpp"

namespace spikeloop::app {

// Each throws a ConfigurationError that names the option, its text and what to write. Times may
// have a unit: "60", "500 ms", "1min".

/// Simulated seconds, from 1 ns to 1e9 s.
double duration_s(const std::string& text);
/// From 0.001 to 1000, as the robot has it.
double real_time_factor(const std::string& text);
/// Wall seconds, above 0 and at most 1e6.
double start_timeout_s(const std::string& text);
/// Wall seconds, at most 1e6; 0: for ever.
double stall_timeout_s(const std::string& text);
/// Up to the largest that the programs read.
std::uint64_t seed(const std::string& text);

/// The option --set KEY=VALUE, repeatable.
void add_settings(CLI::App& command, std::vector<std::string>& texts);
Settings parse_settings(const std::vector<std::string>& texts);

/// The option --no-code, which holds for this process and the programs that it starts.
void add_no_code(CLI::App& command);

/// For an option that names a `what`: an unset variable of a shell is not a name.
CLI::Validator named(const std::string& what);

}  // namespace spikeloop::app
