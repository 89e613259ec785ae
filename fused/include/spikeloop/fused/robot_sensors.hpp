// Topics of the robot that is simulated in this process.
#pragma once

#include "spikeloop/experiment/experiment.hpp"

namespace spikeloop::fused {

/// Makes the experiment's robot once: its topics, and the numbers of values of its messages.
/// @throws Error as robot::SteppedRobot: no such file, or one that cannot be used.
experiment::RobotView look_at_robot(const experiment::Experiment& experiment);

}  // namespace spikeloop::fused
