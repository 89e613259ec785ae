// A recording that replaces the robot.
#pragma once

#include <string>
#include <vector>

#include "spikeloop/experiment/experiment.hpp"

namespace spikeloop::bag {
class Reader;
}

namespace spikeloop::experiment {

/// Returns warnings about a recording: parts and messages that are left out, jumps of its
/// clock, definitions that cannot be used. Errors are left to resolve().
std::vector<std::string> recording_warnings(const Experiment& experiment,
                                            const bag::Reader& reader);

}  // namespace spikeloop::experiment
