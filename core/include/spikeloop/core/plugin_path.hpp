// Where plug-ins are looked for.
#pragma once

#include <string>
#include <string_view>
#include <system_error>
#include <vector>

namespace spikeloop {

/// SPIKELOOP_PLUGIN_PATH: directories divided by ':'; empty when it is not set.
std::string_view plugin_path();

/// The parts of a ':'-separated list that are not empty.
std::vector<std::string> path_list(std::string_view text);

/// The plug-ins in a directory, sorted: libraries, and *.py files that define nodes.
std::vector<std::string> plugin_files(const std::string& directory, std::error_code& error);

}  // namespace spikeloop
