#include "experiment_folder.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "spikeloop/core/error.hpp"
#include "spikeloop/launch/folders.hpp"

namespace spikeloop::app {
namespace {

namespace fs = std::filesystem;

constexpr const char* kResolved = "resolved.json";

/// Made by nobody else at the same time.
std::string first_free(const std::string& experiment) {
  launch::make_folder("runs");
  for (int number = 1;; ++number) {
    const std::string path = fmt::format("runs/{}-{}", experiment, number);
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
  std::ifstream file(folder / kResolved);
  const auto resolved = nlohmann::json::parse(file, nullptr, false);
  if (!resolved.is_object() || !resolved.contains("nodes") || !resolved["nodes"].is_object()) {
    return;
  }
  std::error_code ignored;
  for (const auto& [name, keys] : resolved["nodes"].items()) {
    fs::remove(folder / (fs::path(name).filename().string() + ".h5"), ignored);
  }
  for (const char* name : {"summary.json", "trajectory.csv", "world.json", kResolved}) {
    fs::remove(folder / name, ignored);
  }
}

}  // namespace

ExperimentFolder::ExperimentFolder(const std::string& wanted, const std::string& experiment)
    : shown_(wanted.empty() ? first_free(experiment) : wanted) {
  path_ = launch::make_folder(shown_);
  lock_ = ::open(path_.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (lock_ < 0) {
    throw FileError("open", path_, errno);
  }
  if (::flock(lock_, LOCK_EX | LOCK_NB) != 0) {
    ::close(lock_);
    throw ConfigurationError(fmt::format(
        "another run uses the folder '{}'; wait for its end, or give another --out", shown_));
  }
  remove_earlier(path_);
}

ExperimentFolder::~ExperimentFolder() {
  ::close(lock_);
}

}  // namespace spikeloop::app
