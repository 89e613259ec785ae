// What a run wrote into its folder as JSON.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace spikeloop::app {

/// Null when it is not an object, no regular file, larger than 100 MB or nested deeper than a run
/// writes it (nlohmann-json prints and compares by recursion).
nlohmann::json read_folder_json(const std::string& path);

}  // namespace spikeloop::app
