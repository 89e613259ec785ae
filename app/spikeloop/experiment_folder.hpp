// The run folder of an experiment.
#pragma once

#include <string>

namespace spikeloop::app {

/// Holds the folder while it lives: one folder takes one run at a time.
class ExperimentFolder {
 public:
  /// @param wanted empty: runs/NAME-N, the first N that is free. A folder of an earlier run loses
  /// what that run left there.
  /// @throws FileError when it cannot be made; ConfigurationError when another run uses it.
  ExperimentFolder(const std::string& wanted, const std::string& experiment);
  ~ExperimentFolder();
  ExperimentFolder(const ExperimentFolder&) = delete;
  ExperimentFolder& operator=(const ExperimentFolder&) = delete;

  const std::string& path() const { return path_; }
  /// As a user would write it.
  const std::string& shown() const { return shown_; }

 private:
  std::string path_;
  std::string shown_;
  int lock_ = -1;
};

}  // namespace spikeloop::app
