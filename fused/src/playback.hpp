// Recordings as sources.
#pragma once

#include <memory>

#include "spikeloop/core/endpoint.hpp"
#include "spikeloop/experiment/experiment.hpp"

namespace spikeloop::fused {

/// Port: `out` [width]. What was recorded in an interval comes in that interval once more: then a
/// replay of a sensor gives the same spikes. Reads the whole file.
/// @throws FileError, ConfigurationError: no such file or stream, another width than the
/// connection's.
std::unique_ptr<Source> make_playback(const experiment::Part& part, std::uint32_t width);

}  // namespace spikeloop::fused
