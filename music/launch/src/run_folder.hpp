// The folder that a run writes to, held by this run alone.
#pragma once

#include <string>

#include "spikeloop/config/music_file.hpp"
#include "spikeloop/status/status.hpp"

namespace spikeloop::launch {

class RunFolder {
 public:
  /// Makes it where there is none, and removes what an earlier run wrote that this one may not
  /// write again: recordings of its sections and of those of `file`, summary.json, effective.music.
  /// `path` may be empty: no folder.
  /// @throws FileError when it cannot be made or cleared, or when another run holds it.
  RunFolder(const std::string& path, const MusicFile& file);

  /// Absolute; empty: no folder.
  const std::string& path() const { return path_; }

 private:
  std::string path_;
  status::Descriptor lock_;
};

}  // namespace spikeloop::launch
