// Recordings as sources: what was recorded in an interval comes in that interval once more, so that
// a replay of a sensor gives the same spikes.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "spikeloop/core/endpoint.hpp"
#include "spikeloop/core/parameters.hpp"

namespace spikeloop::record {

/// `file` and `stream`, wherever a recording is named.
std::vector<ParameterDescription> playback_parameters();

/// Port: `out`, as wide as the recording. Reads the whole stream.
/// @throws FileError, ConfigurationError as read_spikes() and read_signal().
std::unique_ptr<Source> make_spike_playback(const std::string& file, const std::string& stream);
std::unique_ptr<Source> make_signal_playback(const std::string& file, const std::string& stream);

}  // namespace spikeloop::record
