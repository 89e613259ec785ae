// Which files a configuration was made of.
#pragma once

#include <set>
#include <string>

namespace spikeloop {

/// While it lives, the files that this thread reads are noted: all that require_regular_file() has
/// seen.
class FilesRead {
 public:
  FilesRead();
  ~FilesRead();
  FilesRead(const FilesRead&) = delete;
  FilesRead& operator=(const FilesRead&) = delete;

  /// Absolute paths.
  const std::set<std::string>& paths() const { return paths_; }

  /// For files that others read.
  static void note(const std::string& path);

 private:
  FilesRead* outer_;
  std::set<std::string> paths_;
};

/// By which contents of files are told apart: 16 hexadecimal digits, made by FNV-1a; empty when the
/// file cannot be read.
std::string file_print(const std::string& path);

}  // namespace spikeloop
