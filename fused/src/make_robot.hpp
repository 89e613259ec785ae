// The robot of an experiment.
#pragma once

#include <memory>
#include <string>

#include "spikeloop/experiment/experiment.hpp"
#include "spikeloop/robot/environment_robot.hpp"
#include "spikeloop/robot/stepped_robot.hpp"

namespace spikeloop::fused {

/// Beside what the experiment says.
struct RobotUse {
  std::string folder{};  ///< Folder of the run's files. Empty if nothing is recorded.
  robot::SpectatorOptions spectators{};
  bool blind = false;                 ///< see robot::SensorOptions
  WriteFailures* failures = nullptr;  ///< see robot::RowFile
  messages::Dialect dialect = messages::Dialect::ros1;
};

/// The experiment's robot, which is simulated in this process.
/// @throws Error as robot::SteppedRobot and robot::EnvironmentRobot.
std::unique_ptr<robot::Robot> make_robot(const experiment::Experiment& experiment,
                                         const RobotUse& use);

}  // namespace spikeloop::fused
