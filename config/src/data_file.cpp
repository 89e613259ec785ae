#include "spikeloop/config/data_file.hpp"

namespace spikeloop {

std::optional<std::filesystem::path> find_data_file(const std::string& name,
                                                    const std::filesystem::path& base) {
  if (name.empty()) {
    return std::nullopt;
  }
  std::error_code ignored;
  for (const auto& path : {base / name, std::filesystem::path(name)}) {
    if (std::filesystem::exists(path, ignored)) {
      return path;
    }
  }
  return std::nullopt;
}

}  // namespace spikeloop
