// The folder that a run writes to.
#pragma once

#include <string>

#include "spikeloop/status/status.hpp"

namespace spikeloop::launch {

/// Holds the folder while it lives: one folder takes one run at a time.
class RunFolder {
 public:
  /// @param wanted empty: PREFIX-N, the first N that is free
  /// @param force results of an earlier run in it are removed; without, they are kept
  /// @throws ConfigurationError when it has such results; FileError when it cannot be made, when
  /// another run that has not ended uses it, or a pipe or device is in it.
  RunFolder(const std::string& wanted, const std::string& prefix, bool force);

  const std::string& path() const { return path_; }  ///< absolute
  /// As a user would write it.
  const std::string& shown() const { return shown_; }

 private:
  std::string shown_;
  std::string path_;
  Descriptor lock_;
};

}  // namespace spikeloop::launch
