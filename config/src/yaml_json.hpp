// Values of a YAML file as they were written; lists and maps also as JSON, for what reads JSON
// already: weights, networks.
#pragma once

#include <yaml-cpp/yaml.h>

#include <string>

#include "spikeloop/core/parameters.hpp"

namespace spikeloop::yaml_text {

/// The JSON of a list or map. Plain values that are numbers, true, false or null stay that; quoted
/// ones are texts.
/// @throws ConfigurationError at the place of what is nested too deeply, of a key that is not a
/// plain value, or when it becomes too large (aliases).
std::string to_json(const std::string& file, const YAML::Node& node);

/// A value with its place, and what it holds. @throws ConfigurationError as to_json().
WrittenValue written_value(const std::string& file, const YAML::Node& node);

}  // namespace spikeloop::yaml_text
