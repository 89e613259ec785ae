// What the keys of endpoints mean, for whoever makes them.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "spikeloop/config/mapping_file.hpp"
#include "spikeloop/core/endpoint.hpp"
#include "spikeloop/core/parameters.hpp"
#include "spikeloop/experiment/experiment.hpp"

namespace spikeloop::experiment {

/// `fields` of a ros_sensor. @throws ConfigurationError when it is no list of paths.
std::vector<std::string> sensor_fields(const Parameters& parameters);
/// `initial` of a ros_sensor. @throws ConfigurationError when it is neither a number nor none.
std::optional<double> sensor_initial(const Parameters& parameters);
/// @throws ConfigurationError at the field that the message does not have.
void check_command_fields(const CommandMapping& mapping);

/// The source of a playback, as wide as its recording, which resolve() has held against the
/// connections. @throws FileError, ConfigurationError: no such file or stream.
std::unique_ptr<Source> playback(const Part& part);

}  // namespace spikeloop::experiment
