// A run that has ended as one MCAP file: what the live view shows of it, but all of it.
#pragma once

#include <functional>
#include <string>

#include "run_recordings.hpp"

namespace spikeloop::app {

/// Writes every spike, every row of every signal and all messages, with the channels of the live
/// view; resolved.json of `folder` is an attachment. Times are simulated times.
/// @param progress called with the simulated time up to which the file is written; false ends it
/// @return false: ended by `progress`; there is no file
/// @throws FileError: the file cannot be written; there is none
bool export_run(const RunRecordings& run, const std::string& folder, const std::string& file,
                const std::function<bool(TimeNs)>& progress);

}  // namespace spikeloop::app
