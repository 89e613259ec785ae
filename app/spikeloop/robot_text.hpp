// A robot in MJCF as text.
#pragma once

#include <string>

namespace spikeloop::app {

/// The topics of the robot that `robot: {simulator: mujoco, model: FILE}` stands for, with the
/// names of its joints and actuators, its cameras and keyframes.
/// @throws Error as vehicle::Simulation.
std::string robot_text(const std::string& file);

}  // namespace spikeloop::app
