#include "run_folder.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>

#include <cerrno>
#include <filesystem>
#include <fstream>

#include "spikeloop/core/error.hpp"
#include "spikeloop/launch/folders.hpp"

namespace spikeloop::launch {
namespace {

namespace fs = std::filesystem;

constexpr const char* kEffective = "effective.music";

/// The lock is the folder's own: there is no file to leave behind, and it goes with the process.
/// A file of the user's may have the name of a section, too.
bool is_recording(const fs::path& path) {
  if (std::error_code ignored; !fs::is_regular_file(path, ignored)) {
    return false;
  }
  std::ifstream file(path, std::ios::binary);
  std::string head(4096, '\0');
  file.read(head.data(), static_cast<std::streamsize>(head.size()));
  return head.starts_with("\x89HDF") && head.find("spikeloop_format") != std::string::npos;
}

/// The sections of the run that used the folder before; none when nobody can tell.
std::vector<std::string> earlier_labels(const fs::path& folder) {
  try {
    return read_music_file((folder / kEffective).string()).labels();
  } catch (const Error&) {
    return {};
  }
}

void remove_file(const fs::path& path) {
  std::error_code error;
  fs::remove(path, error);
  if (error) {
    throw FileError("remove", path.string(), error.value());
  }
}

}  // namespace

RunFolder::RunFolder(const std::string& path, const MusicFile& file) {
  if (!path.empty()) {
    path_ = make_folder(path);
    refuse_to_overwrite(file.path, (fs::path(path_) / kEffective).string());
    lock_ = lock_folder(path_, path);
    labels_ = earlier_labels(path_);
    const std::vector<std::string> present = file.labels();
    labels_.insert(labels_.end(), present.begin(), present.end());
  }
}

void RunFolder::clear() const {
  if (path_.empty()) {
    return;
  }
  for (const std::string& label : labels_) {
    const fs::path recording = fs::path(path_) / (label + ".h5");
    if (is_recording(recording)) {
      remove_file(recording);
    }
  }
  remove_file(fs::path(path_) / "summary.json");
}

}  // namespace spikeloop::launch
