// The lines of `connections` in an experiment file.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "spikeloop/config/experiment_file.hpp"

namespace spikeloop::experiment_text {

/// Appends the arrows of "a -> b.in [2] -> c [3, delay 5 ms]", of which the second begins at b's
/// only output, and those of each sender of "a, b.out -> c"; `where` is where the text begins.
/// @throws ConfigurationError at the place of what cannot be read.
void read_connections(const std::string& text, const Location& where,
                      std::vector<ExperimentConnection>& connections);

/// The senders of "scan", "left, right.out[0:50]" or "a + b": connections that lead nowhere yet.
/// @throws ConfigurationError at the place of what cannot be read.
std::vector<ExperimentConnection> read_senders(const std::string& text, const Location& where);

/// The width of a connection that is written as a map.
std::uint32_t read_width(const std::string& text, const Location& where);
/// @throws ConfigurationError when it is neither NODE nor NODE.PORT.
void check_end(const std::string& text, const Location& where);

}  // namespace spikeloop::experiment_text
