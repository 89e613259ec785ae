// Mapping files of sensors: what is taken of their messages.
//
//   {"fields": ["pose.pose.position.x", {"path": "ranges[0:100]", "range": [0, 4], "nan": "hold"}]}
//   {"image": {"resize": [40, 30], "filter": "on_off"}}
#pragma once

#include <filesystem>
#include <string>

#include "spikeloop/core/parameters.hpp"

namespace spikeloop {

/// The file's keys, `fields` and `image`, with their values as JSON, for sensing::sensor_rule().
/// @param base where relative paths start, or else the current directory
/// @throws ConfigurationError with place and remedy: no such file, no JSON, no object, another key,
/// neither of the two; FileError when it cannot be read.
WrittenValues read_sensor_mapping(const std::string& name, const std::filesystem::path& base);

}  // namespace spikeloop
