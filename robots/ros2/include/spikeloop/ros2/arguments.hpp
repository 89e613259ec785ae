// ROS 2's own arguments on a command line.
#pragma once

#include <string>
#include <vector>

#include "spikeloop/ros2/names.hpp"

namespace spikeloop::ros2 {

struct CommandLine {
  std::vector<std::string> own;  ///< the program's name and what it understands itself
  Remappings ros;
};

/// ROS 2 puts its arguments between `--ros-args` and `--` or the end: `-r FROM:=TO` are kept; what
/// Spikeloop has no use for (`-p NAME:=VALUE`, `--params-file`, `--log-level`, `--enclave`...) is
/// said and left out. FROM:=TO elsewhere counts as well, as ROS 1 writes it.
/// @throws ConfigurationError for an argument of ROS 2's without its value, and for one that ROS 2
/// does not have.
CommandLine split_command_line(int argc, const char* const* argv);

}  // namespace spikeloop::ros2
