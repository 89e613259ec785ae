#include "spikeloop/processes/scratch_folder.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <signal.h>
#include <stdlib.h>
#include <sys/file.h>
#include <sys/prctl.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <filesystem>
#include <string_view>
#include <thread>

#include "spikeloop/core/error.hpp"

namespace spikeloop {
namespace {

namespace fs = std::filesystem;

/// No other program makes folders with this name: a folder that matches is removed.
constexpr std::string_view kPrefix = "spikeloop-scratch-";
constexpr std::string_view kPattern = "XXXXXX";

int open_folder(const std::string& path) {
  return open(path.c_str(), O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
}

/// True if the open folder is still the one at `path`: another run may have removed it.
bool is_same_folder(int folder, const std::string& path) {
  struct stat open {};
  struct stat named {};
  return fstat(folder, &open) == 0 && lstat(path.c_str(), &named) == 0 &&
         open.st_ino == named.st_ino && open.st_dev == named.st_dev;
}

/// Programs that end late may still write into it.
void remove_folder(const std::string& path) {
  for (int tries = 50; tries > 0; --tries) {
    std::error_code error;
    fs::remove_all(path, error);
    if (!error) {
      return;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
}

/// In the forked process. A lock on a file ends with the last copy of the descriptor that has it.
[[noreturn]] void remove_when_unlocked(const std::string& path) {
  sigset_t every;
  sigfillset(&every);
  sigprocmask(SIG_SETMASK, &every, nullptr);
  setpgid(0, 0);
  prctl(PR_SET_NAME, "spikeloop-tidy");
  closefrom(0);
  const int folder = open_folder(path);
  if (folder >= 0 && flock(folder, LOCK_EX) == 0) {
    remove_folder(path);
  }
  _exit(0);
}

/// The new folder, open and locked. Empty if another run has removed it: a folder without a lock
/// looks like an abandoned one. @throws FileError
Descriptor lock_folder(const std::string& path) {
  Descriptor folder{open_folder(path)};
  if (folder.get() < 0 && errno == ENOENT) {
    return Descriptor{};
  }
  if (folder.get() < 0 || flock(folder.get(), LOCK_EX) != 0) {
    throw FileError("lock the folder", path, errno);
  }
  if (!is_same_folder(folder.get(), path)) {
    folder.reset();
  }
  return folder;
}

/// Removes a folder of this user that no process has locked.
void remove_if_abandoned(const std::string& path) {
  const Descriptor folder{open_folder(path)};
  struct stat status {};
  if (fstat(folder.get(), &status) == 0 && status.st_uid == geteuid() &&
      flock(folder.get(), LOCK_EX | LOCK_NB) == 0 && is_same_folder(folder.get(), path)) {
    remove_folder(path);
  }
}

/// Removes what killed runs have left in `parent`.
void remove_abandoned(const std::string& parent) {
  std::error_code error;
  for (fs::directory_iterator entry(parent, error), end; !error && entry != end;
       entry.increment(error)) {
    const std::string name = entry->path().filename();
    if (name.starts_with(kPrefix) && name.size() == kPrefix.size() + kPattern.size()) {
      remove_if_abandoned(entry->path());
    }
  }
}

}  // namespace

std::string scratch_parent() {
  return access("/dev/shm", W_OK | X_OK) == 0 ? "/dev/shm" : "/tmp";
}

ScratchFolder::ScratchFolder() : ScratchFolder(scratch_parent()) {}

ScratchFolder::ScratchFolder(const std::string& parent) {
  remove_abandoned(parent);
  while (folder_.get() < 0) {
    path_ = fmt::format("{}/{}{}", parent, kPrefix, kPattern);
    if (mkdtemp(path_.data()) == nullptr) {
      throw FileError("make the folder", path_, errno);
    }
    folder_ = lock_folder(path_);
  }
  start_remover();
}

void ScratchFolder::start_remover() {
  remover_ = fork();
  if (remover_ == 0) {
    remove_when_unlocked(path_);
  }
}

bool ScratchFolder::restart_remover() {
  int status = 0;
  if (remover_ <= 0 || waitpid(remover_, &status, WNOHANG) != remover_) {
    return false;
  }
  if (!WIFSIGNALED(status)) {
    remover_ = -1;  // it ended by itself: the folder has been removed by another program
    return false;
  }
  start_remover();
  return true;
}

ScratchFolder::~ScratchFolder() {
  if (remover_ > 0) {
    kill(remover_, SIGKILL);
    waitpid(remover_, nullptr, 0);
  }
  remove_folder(path_);
}

}  // namespace spikeloop
