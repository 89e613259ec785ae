// A folder for what a program needs for a while.
#pragma once

#include <string>

namespace spikeloop {

/// Is removed with everything in it when the object is.
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

 private:
  std::string path_;
};

}  // namespace spikeloop
