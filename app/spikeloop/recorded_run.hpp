// What a run of an experiment left in its folder, as far as a replay needs it.
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "spikeloop/core/time.hpp"
#include "spikeloop/experiment/experiment.hpp"

namespace spikeloop::app {

struct RecordedRun {
  std::string folder;  ///< as it was written
  nlohmann::json resolved;
  nlohmann::json summary;
  std::string experiment_file;  ///< the copy
  std::string origin;           ///< where its relative paths start
  experiment::Replay replay;
  std::string changes;  ///< its changes.csv; empty: there is none
  double simulated_s = 0;
  Settings settings;  ///< that the run had, and those of a replay
};

/// @throws ConfigurationError when the run would write into the one that it repeats.
void refuse_own_folder(const std::string& out, const std::string& folder);

/// @throws FileError: no such folder; ConfigurationError: no run that can be replayed, and why.
RecordedRun read_recorded_run(const std::string& folder);

/// What `spikeloop run FOLDER` runs again: of the run its experiment, origin and settings.
/// @throws as read_recorded_run(), but recordings and messages need not be there.
RecordedRun read_run_again(const std::string& folder);

/// Why the replay may differ, as far as the folder knows: messages that were dropped, files that
/// have changed, another version.
std::vector<std::string> doubts(const RecordedRun& run);
/// The same of the experiment as it is now: keys or connections with other values.
std::vector<std::string> doubts(const RecordedRun& run, const nlohmann::json& resolved_now);

}  // namespace spikeloop::app
