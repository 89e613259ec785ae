// Lists and maps of a YAML file as JSON, for what reads JSON already: weights, mappings.
#pragma once

#include <yaml-cpp/yaml.h>

#include <string>

namespace spikeloop::yaml_text {

/// The JSON of a list or map. Plain values that are numbers, true, false or null stay that; quoted
/// ones are texts.
/// @throws ConfigurationError at the place of what is nested too deeply, of a key that is no plain
/// value, or when it becomes too large (aliases).
std::string to_json(const std::string& file, const YAML::Node& node);

}  // namespace spikeloop::yaml_text
