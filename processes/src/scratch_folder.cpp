#include "spikeloop/core/scratch_folder.hpp"

#include <stdlib.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <filesystem>
#include <thread>

#include "spikeloop/core/error.hpp"

namespace spikeloop {

ScratchFolder::ScratchFolder()
    : ScratchFolder(access("/dev/shm", W_OK | X_OK) == 0 ? "/dev/shm" : "/tmp") {}

ScratchFolder::ScratchFolder(const std::string& parent) : path_(parent + "/spikeloop-XXXXXX") {
  if (mkdtemp(path_.data()) == nullptr) {
    throw FileError("make the folder", path_, errno);
  }
}

ScratchFolder::~ScratchFolder() {
  // Programs that end late may still write into it.
  for (int tries = 50; tries > 0; --tries) {
    std::error_code error;
    std::filesystem::remove_all(path_, error);
    if (!error) {
      return;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
}

}  // namespace spikeloop
