// Summary of a run, and the warnings at its end.
#pragma once

#include <nlohmann/json.hpp>

#include "assembly.hpp"
#include "spikeloop/fused/run.hpp"

namespace spikeloop::fused {

/// Counters, times and sums for summary.json, without the outcome.
nlohmann::json summary_of(const experiment::Experiment& experiment,
                          const Surroundings& surroundings, Assembly& assembly,
                          const Progress& progress);

/// Warns of each sensor that has received no message. @param summary as of summary_of()
void warn_of_silence(const experiment::Experiment& experiment, const Transport& transport,
                     const nlohmann::json& summary);

/// Warns if the machine is too slow for the run, and reports the speed that it can sustain.
/// @param computing wall time of all ticks without waiting
void warn_of_overruns(const experiment::Experiment& experiment, const Progress& progress,
                      TimeNs computing);

}  // namespace spikeloop::fused
