// Arguments of ROS on a command line.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "spikeloop/messages/dialect.hpp"

namespace spikeloop::topics {

/// NAME:=VALUE: the new name of a topic, or a special key of ROS (`__name`, `__master`, `__ns`...).
using RosArguments = std::map<std::string, std::string>;

struct CommandLine {
  std::vector<std::string> own;  ///< the program's name and its own arguments
  RosArguments ros;
  /// Arguments after --ros-args that Spikeloop ignores: "-p rate:=5".
  std::vector<std::string> foreign;
  /// True if time is that of /clock; nullopt if not given. The only parameter that launch files
  /// give to all nodes: `-p use_sim_time:=true`, or a file without other parameters.
  std::optional<bool> use_sim_time{};
};

/// Launch files add arguments to those of the user. ROS 1: those that contain ":=". ROS 2: those
/// after --ros-args, up to the end or "--"; names follow -r, and `__node` is `__name`.
/// @throws ConfigurationError for a -r without NAME:=VALUE.
CommandLine split_command_line(int argc, const char* const* argv);

/// Formats arguments as split_command_line() accepts them: "/scan:=/front/scan __ns:=/arena".
std::string to_text(const RosArguments& arguments);
/// Parses the result of to_text(). @throws ConfigurationError for a word other than NAME:=VALUE.
RosArguments read_ros_arguments(const std::string& text);

/// @throws ConfigurationError for invalid names, and for keys other than topics, `__ns` and
/// `__name`.
void check_ros_arguments(messages::Dialect ros, const RosArguments& arguments);

/// Full name of a topic ("/scan") after these arguments have been applied.
std::string renamed(const std::string& whole_topic, const RosArguments& arguments);

}  // namespace spikeloop::topics
