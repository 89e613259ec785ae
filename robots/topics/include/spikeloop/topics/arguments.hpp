// ROS's own arguments on a command line.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "spikeloop/messages/dialect.hpp"

namespace spikeloop::topics {

/// NAME:=VALUE: a topic's other name, or what ROS calls `__name`, `__master`, `__ns`...
using RosArguments = std::map<std::string, std::string>;

struct CommandLine {
  std::vector<std::string> own;  ///< the program's name and what it understands itself
  RosArguments ros;
  /// "-p rate:=5": what stands behind --ros-args and means nothing to our programs.
  std::vector<std::string> foreign;
  /// The one parameter that launch files give all nodes: `-p use_sim_time:=true`, or a file of
  /// parameters with no other. Whether time is that of /clock.
  std::optional<bool> use_sim_time{};
};

/// Launch files add arguments to those a user writes; ROS 1 tells them by the ":=" in them. ROS 2
/// puts them behind --ros-args, up to the end or "--": names behind -r, where `__node` is `__name`.
/// @throws ConfigurationError for a -r without NAME:=VALUE.
CommandLine split_command_line(int argc, const char* const* argv);

/// "/scan:=/front/scan __ns:=/arena", as split_command_line() takes it.
std::string to_text(const RosArguments& arguments);
/// The other way round. @throws ConfigurationError for a word that is not a NAME:=VALUE.
RosArguments read_ros_arguments(const std::string& text);

/// @throws ConfigurationError for names that are none, and for what is neither a topic nor `__ns`
/// nor `__name`.
void check_ros_arguments(messages::Dialect ros, const RosArguments& arguments);

/// A topic's whole name ("/scan") once these arguments have given it another one.
std::string renamed(const std::string& whole_topic, const RosArguments& arguments);

}  // namespace spikeloop::topics
