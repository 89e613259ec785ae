#include "spikeloop/config/data_file.hpp"

#include <fmt/format.h>

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

std::string data_file_places(const std::filesystem::path& base) {
  std::error_code ignored;
  const auto here = std::filesystem::current_path(ignored);
  const bool elsewhere = !base.empty() && !std::filesystem::equivalent(base, here, ignored);
  return fmt::format("'{}'{}", here.string(),
                     elsewhere ? fmt::format(" or '{}'", base.string()) : "");
}

}  // namespace spikeloop
