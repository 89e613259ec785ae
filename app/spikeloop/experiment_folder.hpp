// The run folder of an experiment.
#pragma once

#include <string>

#include "spikeloop/status/status.hpp"

namespace spikeloop::app {

/// Holds the folder while it lives: one folder takes one run at a time.
class ExperimentFolder {
 public:
  /// @param wanted empty: PREFIX-N, the first N that is free. A folder of an earlier run loses what
  /// that run left there.
  /// @throws FileError when it cannot be made, or another run uses it.
  ExperimentFolder(const std::string& wanted, const std::string& prefix);

  const std::string& path() const { return path_; }
  /// As a user would write it.
  const std::string& shown() const { return shown_; }
  /// Somebody else holds it from now on.
  void release() { lock_.reset(); }

 private:
  std::string path_;
  std::string shown_;
  Descriptor lock_;
};

}  // namespace spikeloop::app
