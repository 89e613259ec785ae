#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cstdlib>
#include <filesystem>
#include <vector>

#include "spikeloop/core/code.hpp"
#include "spikeloop/core/error.hpp"
#include "spikeloop/vehicle/vehicle.hpp"

namespace spikeloop::vehicle {
namespace {

namespace fs = std::filesystem;

// Programs stand in PREFIX/bin or build/bin, test programs one directory deeper.
constexpr int kLevelsUp = 3;

std::vector<std::string> shipped_directories() {
  std::vector<std::string> directories;
  if (const char* share = std::getenv("SPIKELOOP_SHARE")) {
    directories.push_back((fs::path(share) / "worlds").string());
  }
  std::error_code ignored;
  fs::path directory = fs::read_symlink("/proc/self/exe", ignored).parent_path();
  for (int level = 0; level < kLevelsUp && directory.has_relative_path(); ++level) {
    directory = directory.parent_path();
    directories.push_back((directory / "share/spikeloop/worlds").string());
  }
  return directories;
}

}  // namespace

std::string find_world(const std::string& name) {
  const bool bare = !fs::path(name).has_parent_path();
  if (fs::exists(name) && !(bare && fs::is_directory(name))) return name;
  if (!bare) {
    throw FileError("open world", name, ENOENT);
  }
  const auto directories = shipped_directories();
  for (const auto& directory : directories) {
    for (const std::string& file : {name, name + ".xml"}) {
      const fs::path candidate = fs::path(directory) / file;
      if (fs::exists(candidate)) return candidate.string();
    }
  }
  throw FileError(
      with_code(Code::missing_file,
                "cannot find world '{}': no such file here, nor in {}; write the path of an MJCF "
                "file, or arena, phototaxis, t_maze or lane for a shipped world",
                name, fmt::join(directories, ", ")));
}

}  // namespace spikeloop::vehicle
