// ROS's own arguments on a command line.
#pragma once

#include <map>
#include <string>
#include <vector>

namespace spikeloop::ros1 {

/// NAME:=VALUE: a topic's other name, or what ROS calls `__name`, `__master`, `__ns`...
using RosArguments = std::map<std::string, std::string>;

struct CommandLine {
  std::vector<std::string> own;  ///< the program's name and what it understands itself
  RosArguments ros;
};

/// roslaunch adds arguments to those a user writes; ROS tells them by the ":=" in them.
CommandLine split_command_line(int argc, const char* const* argv);

}  // namespace spikeloop::ros1
