// A folder for what a program needs for a while.
#pragma once

#include <sys/types.h>

#include <string>

#include "spikeloop/processes/descriptor.hpp"

namespace spikeloop {

/// Parent of scratch folders: /dev/shm, which is in memory, or /tmp if this user cannot write to
/// /dev/shm.
std::string scratch_parent();

/// A temporary folder, removed by the destructor. If the program is killed, a helper process
/// removes it once no process holds descriptor(); otherwise the next object with this parent does.
class ScratchFolder {
 public:
  /// In memory where the machine has such a place; the path is short, because sockets in it may
  /// have 107 characters. @throws FileError
  ScratchFolder();
  /// In `parent`.
  explicit ScratchFolder(const std::string& parent);
  ~ScratchFolder();
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;

  const std::string& path() const { return path_; }
  /// Starts the removing process again if it was killed. Returns true if it was.
  bool restart_remover();
  /// For processes that may outlive us and still need the folder.
  int descriptor() const { return folder_.get(); }

 private:
  void start_remover();

  std::string path_;
  Descriptor folder_;
  pid_t remover_ = -1;
};

}  // namespace spikeloop
