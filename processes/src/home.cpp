#include "spikeloop/processes/home.hpp"

#include <fmt/format.h>
#include <pwd.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>
#include <string>

namespace spikeloop {
namespace {

/// mpirun only requires a name. Programs cannot write there.
constexpr const char* kNoHome = "/nonexistent";

/// Empty if there is none.
std::string home() {
  if (const char* const named = getenv("HOME"); named != nullptr && *named != '\0') {
    return named;
  }
  const passwd* const entry = getpwuid(getuid());
  return entry == nullptr || entry->pw_dir == nullptr ? "" : entry->pw_dir;
}

/// A directory that no other user can write to, which later runs use again. Empty if another user
/// has made it: programs load settings and libraries from their home directory.
std::string private_directory() {
  std::error_code error;
  const auto parent = std::filesystem::temp_directory_path(error);
  const std::string path = fmt::format("{}/spikeloop-home-{}", parent.string(), getuid());
  mkdir(path.c_str(), 0700);
  struct stat found {};
  const bool is_ours = lstat(path.c_str(), &found) == 0 && S_ISDIR(found.st_mode) &&
                       found.st_uid == geteuid() && (found.st_mode & 077) == 0;
  return is_ours ? path : "";
}

}  // namespace

void provide_home() {
  const std::string before = home();
  const bool is_writable = !before.empty() && access(before.c_str(), W_OK | X_OK) == 0;
  if (is_writable) {
    return;
  }
  const std::string directory = private_directory();
  if (before.empty()) {
    setenv("HOME", directory.empty() ? kNoHome : directory.c_str(), 1);
  }
  if (!directory.empty()) {
    setenv("MPLCONFIGDIR", (directory + "/matplotlib").c_str(), 0);
  }
}

}  // namespace spikeloop
