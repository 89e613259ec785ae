// The folder that a run writes to, held by this run alone.
#pragma once

#include <string>
#include <vector>

#include "spikeloop/config/music_file.hpp"
#include "spikeloop/status/status.hpp"

namespace spikeloop::launch {

class RunFolder {
 public:
  /// Makes it where there is none. `path` may be empty: no folder.
  /// @throws FileError when it cannot be made, or when another run holds it; ConfigurationError
  /// when effective.music there is `file` itself.
  RunFolder(const std::string& path, const MusicFile& file);

  /// Removes what an earlier run wrote that this one may not write again: recordings of its
  /// sections and of those of the file, summary.json. A run that does not begin leaves them alone.
  /// @throws FileError
  void clear() const;

  /// Absolute; empty: no folder.
  const std::string& path() const { return path_; }

 private:
  std::string path_;
  std::vector<std::string> labels_;  ///< of this run's sections and the earlier one's
  Descriptor lock_;
};

}  // namespace spikeloop::launch
