// Topics of the robot that is simulated in this process.
#pragma once

#include "spikeloop/experiment/experiment.hpp"

namespace spikeloop::fused {

/// Makes the robot once: its topics, and the numbers of values of its messages.
/// @param ros whose messages they are
/// @throws Error as robot::make_robot: no such file, or one that cannot be used.
experiment::RobotView look_at_robot(const experiment::Robot& robot, messages::Dialect ros);

}  // namespace spikeloop::fused
