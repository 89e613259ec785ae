// What the robot that is simulated in this process tells its sensors.
#pragma once

#include "spikeloop/experiment/experiment.hpp"

namespace spikeloop::fused {

/// Makes the robot once; the numbers of values are those of its messages.
/// @param ros whose messages they are
/// @throws Error as vehicle::Vehicle: no such world, or one that cannot be used.
experiment::SensorWidth look_at_robot(const experiment::Robot& robot, messages::Dialect ros);

}  // namespace spikeloop::fused
