// Parameters that were changed while an experiment ran: changes.csv of the run folder.
#pragma once

#include <string>
#include <vector>

#include "spikeloop/core/time.hpp"

namespace spikeloop::experiment {

inline constexpr const char* kChangesFile = "changes.csv";
inline constexpr const char* kChangesHead = "t_ns,parameter,value";

struct Change {
  TimeNs time = 0;  ///< the begin of the first tick that it holds for
  std::string node;
  std::string parameter;
  double value = 0;
};

/// A row of the file, without the end of the line.
std::string to_text(const Change& change);

/// By time; those of one time in the order of the file.
/// @throws FileError: it cannot be read; ConfigurationError with the line: it has another form.
std::vector<Change> read_changes(const std::string& path);

}  // namespace spikeloop::experiment
