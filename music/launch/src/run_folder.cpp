#include "spikeloop/launch/run_folder.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <vector>

#include "spikeloop/core/code.hpp"
#include "spikeloop/core/error.hpp"
#include "spikeloop/launch/folders.hpp"

namespace spikeloop::launch {
namespace {

namespace fs = std::filesystem;

constexpr const char* kSummary = "summary.json";
constexpr const char* kFilesFolder = "experiment-files";
/// What a run writes beside its recordings, and another one need not write again.
constexpr const char* kFiles[] = {kSummary,       "resolved.json", "trajectory.csv",
                                  "episodes.csv", "world.json",    "messages.mcap",
                                  "changes.csv",  "log.txt",       "versions.json"};

/// Made by nobody else at the same time.
std::string first_free(const std::string& prefix) {
  make_folder(fs::absolute(prefix).parent_path().string());
  for (int number = 1;; ++number) {
    const std::string path = fmt::format("{}-{}", prefix, number);
    std::error_code error;
    if (fs::create_directory(path, error)) {
      return path;
    }
    if (error && error != std::errc::file_exists) {  // a link without a target, for example
      throw FileError("make directory", path, error.value());
    }
  }
}

/// Not a file of the user's with such a name.
bool is_recording(const fs::path& path) {
  std::error_code ignored;
  if (path.extension() != ".h5" || !fs::is_regular_file(path, ignored)) {
    return false;
  }
  std::ifstream file(path, std::ios::binary);
  std::string head(4096, '\0');
  file.read(head.data(), static_cast<std::streamsize>(head.size()));
  return head.starts_with("\x89HDF") && head.find("spikeloop_format") != std::string::npos;
}

std::vector<fs::path> recordings(const std::string& folder) {
  std::vector<fs::path> found;
  for (const auto& entry : fs::directory_iterator(folder)) {
    if (is_recording(entry.path())) {
      found.push_back(entry.path());
    }
  }
  return found;
}

/// Discarded when there is none.
nlohmann::json read_json(const fs::path& path) {
  std::error_code ignored;
  if (!fs::is_regular_file(path, ignored)) {
    return nlohmann::json(nlohmann::json::value_t::discarded);
  }
  std::ifstream file(path);
  return nlohmann::json::parse(file, nullptr, false);
}

/// A run that never began leaves a summary, too.
bool has_ticked(const fs::path& folder) {
  const auto contents = read_json(folder / kSummary);
  return contents.is_object() && contents.contains("simulated_s") &&
         contents["simulated_s"].is_number() && contents["simulated_s"] > 0;
}

/// Links count: a run would write its file in place of the link.
std::vector<fs::path> files_in_the_way(const fs::path& folder) {
  std::vector<fs::path> found;
  for (const char* name : kFiles) {
    if (fs::exists(fs::symlink_status(folder / name))) {
      found.push_back(folder / name);
    }
  }
  for (const auto& entry : fs::directory_iterator(folder)) {
    const fs::path name = entry.path().filename();
    if (entry.is_symlink() && (name.extension() == ".h5" || name == kFilesFolder)) {
      found.push_back(entry.path());
    }
  }
  return found;
}

/// Its files may be removed; what has their names in another folder is somebody else's.
bool is_run_folder(const fs::path& folder) {
  std::error_code ignored;
  const auto contents = read_json(folder / "resolved.json");
  return fs::exists(folder / "effective.music", ignored) ||
         (contents.is_object() && contents.contains("experiment_file") &&
          contents.contains("nodes"));
}

void remove_file(const fs::path& path) {
  std::error_code error;
  fs::remove(path, error);
  if (error) {
    throw FileError("remove", path.string(), error.value());
  }
}

}  // namespace

RunFolder::RunFolder(const std::string& wanted, const std::string& prefix, bool force)
    : shown_(wanted.empty() ? first_free(prefix) : wanted),
      path_(make_folder(shown_)),
      lock_(lock_folder(path_, shown_)) {
  const fs::path folder = path_;
  const bool ours = is_run_folder(folder);
  const auto earlier = recordings(path_);
  if (!force && (!earlier.empty() || has_ticked(folder))) {
    throw ConfigurationError(with_code(Code::no_access,
                                       "the folder '{}' has the results of a run; write --force to "
                                       "replace them, or give another folder with --out",
                                       shown_));
  }
  if (!ours) {
    for (const fs::path& file : files_in_the_way(folder)) {
      if (!force) {
        throw ConfigurationError(with_code(Code::no_access,
                                           "the folder '{}' is not that of a run, and has a file "
                                           "'{}', which a run writes; write --force to replace it, "
                                           "or give another folder with --out",
                                           shown_, file.filename().string()));
      }
      if (fs::is_symlink(file)) {
        remove_file(file);
      }
    }
    return;
  }
  std::error_code ignored;
  fs::remove_all(folder / kFilesFolder, ignored);
  // The summary first: whoever finds one finds the recordings that it is about.
  for (const char* name : kFiles) {
    remove_file(folder / name);
  }
  for (const fs::path& recording : earlier) {
    remove_file(recording);
  }
}

}  // namespace spikeloop::launch
