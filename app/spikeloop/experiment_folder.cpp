#include "experiment_folder.hpp"

#include <fmt/format.h>

#include <filesystem>

#include "folder_json.hpp"
#include "spikeloop/core/error.hpp"
#include "spikeloop/fused/run.hpp"
#include "spikeloop/launch/folders.hpp"

namespace spikeloop::app {
namespace {

namespace fs = std::filesystem;

constexpr const char* kResolved = "resolved.json";

/// Made by nobody else at the same time.
std::string first_free(const std::string& prefix) {
  launch::make_folder(fs::absolute(prefix).parent_path().string());
  for (int number = 1;; ++number) {
    const std::string path = fmt::format("{}-{}", prefix, number);
    std::error_code error;
    if (fs::create_directory(path, error)) {
      return path;
    }
    if (error) {
      throw FileError("make directory", path, error.value());
    }
  }
}

/// What an earlier run of ours left; nothing else is touched.
void remove_earlier(const fs::path& folder) {
  const auto resolved = read_folder_json((folder / kResolved).string());
  if (!resolved.is_object() || !resolved.contains("nodes") || !resolved["nodes"].is_object()) {
    return;
  }
  // The summary first: whoever finds one finds the recordings that it tells of.
  std::error_code ignored;
  fs::remove(folder / "summary.json", ignored);
  for (const auto& [name, keys] : resolved["nodes"].items()) {
    fs::remove(folder / (fs::path(name).filename().string() + ".h5"), ignored);
  }
  for (const char* name :
       {"trajectory.csv", "world.json", "log.txt", fused::kMessagesFile, kResolved}) {
    fs::remove(folder / name, ignored);
  }
}

}  // namespace

ExperimentFolder::ExperimentFolder(const std::string& wanted, const std::string& prefix)
    : shown_(wanted.empty() ? first_free(prefix) : wanted) {
  path_ = launch::make_folder(shown_);
  lock_ = launch::lock_folder(path_, shown_);
  remove_earlier(path_);
}

}  // namespace spikeloop::app
