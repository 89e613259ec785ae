// Checks the recording that replaces a robot, and reports what a run would report.
#pragma once

#include "spikeloop/core/diagnostic.hpp"
#include "spikeloop/core/time.hpp"
#include "spikeloop/experiment/experiment.hpp"

namespace spikeloop::app {

struct RecordingCheck {
  Diagnostics diagnostics;  ///< the error that would end the run comes last
  TimeNs checked = 0;       ///< shorter than the experiment if the recording is large
};

/// Passes the messages of the recording to the sensors of an experiment that has one, as a run
/// does, for at most 4 s of wall time. Commands run as well if sensors alone are connected to them;
/// nothing else of the experiment runs.
RecordingCheck check_recording(const experiment::Experiment& experiment);

}  // namespace spikeloop::app
