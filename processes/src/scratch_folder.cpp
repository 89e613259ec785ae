#include "spikeloop/processes/scratch_folder.hpp"

#include <fcntl.h>
#include <signal.h>
#include <stdlib.h>
#include <sys/file.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <filesystem>
#include <thread>

#include "spikeloop/core/error.hpp"

namespace spikeloop {
namespace {

int open_folder(const std::string& path) {
  return open(path.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
}

/// Programs that end late may still write into it.
void remove_folder(const std::string& path) {
  for (int tries = 50; tries > 0; --tries) {
    std::error_code error;
    std::filesystem::remove_all(path, error);
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

}  // namespace

ScratchFolder::ScratchFolder()
    : ScratchFolder(access("/dev/shm", W_OK | X_OK) == 0 ? "/dev/shm" : "/tmp") {}

ScratchFolder::ScratchFolder(const std::string& parent) : path_(parent + "/spikeloop-XXXXXX") {
  if (mkdtemp(path_.data()) == nullptr) {
    throw FileError("make the folder", path_, errno);
  }
  folder_ = Descriptor{open_folder(path_)};
  if (folder_.get() >= 0 && flock(folder_.get(), LOCK_EX) == 0) {
    remover_ = fork();
    if (remover_ == 0) {
      remove_when_unlocked(path_);
    }
  }
}

ScratchFolder::~ScratchFolder() {
  if (remover_ > 0) {
    kill(remover_, SIGKILL);
    waitpid(remover_, nullptr, 0);
  }
  remove_folder(path_);
}

}  // namespace spikeloop
