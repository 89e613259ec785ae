// Values of the command line in place of those of an experiment file.
#pragma once

#include <yaml-cpp/yaml.h>

#include "spikeloop/config/experiment_file.hpp"

namespace spikeloop::experiment_text {

/// Changes the document as if the file had been written so.
/// @throws ConfigurationError that begins with the option: no such node or entry, not YAML.
void apply(const Setting& setting, YAML::Node document);

/// Errors about the value name the option in place of the file.
void mark_place(const Setting& setting, ExperimentFile& file);

}  // namespace spikeloop::experiment_text
