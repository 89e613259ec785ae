// Checks the files of a run while it goes on.
#pragma once

#include <string>

#include "spikeloop/core/write_failures.hpp"
#include "spikeloop/fused/run.hpp"
#include "spikeloop/processes/descriptor.hpp"

namespace spikeloop::fused {

class FileWatch {
 public:
  FileWatch(const RunOptions& options, OnWriteFailure policy);

  /// To be called every tick; looks ten times a second whether the run folder was deleted.
  /// @param now wall time
  /// @throws FileError, as WriteFailures::check().
  void check(TimeNs now);

 private:
  std::string folder_;
  Descriptor open_folder_;
  WriteFailures& failures_;
  OnWriteFailure policy_;
  TimeNs next_ = 0;  // wall time
};

}  // namespace spikeloop::fused
