// ROS's own arguments on a command line.
#pragma once

#include <map>
#include <string>
#include <vector>

namespace spikeloop::topics {

/// NAME:=VALUE: a topic's other name, or what ROS calls `__name`, `__master`, `__ns`...
using RosArguments = std::map<std::string, std::string>;

struct CommandLine {
  std::vector<std::string> own;  ///< the program's name and what it understands itself
  RosArguments ros;
};

/// Launch files add arguments to those a user writes; ROS 1 tells them by the ":=" in them. ROS 2
/// puts them behind --ros-args, up to the end or "--": names behind -r, where `__node` is `__name`;
/// the rest (parameters, log levels) means nothing to our programs and is left out.
CommandLine split_command_line(int argc, const char* const* argv);

}  // namespace spikeloop::topics
