// Where the files that a configuration names are looked for.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace spikeloop {

/// The file of this name relative to `base` (the directory of the file that names it), else
/// relative to the current directory; an absolute path as it is. Nothing when there is none.
std::optional<std::filesystem::path> find_data_file(const std::string& name,
                                                    const std::filesystem::path& base);

/// Where find_data_file() looks: "'/here'" or "'/here' or '/there'".
std::string data_file_places(const std::filesystem::path& base);

}  // namespace spikeloop
