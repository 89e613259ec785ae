#include "ros_arguments.hpp"

#include <fmt/format.h>

#include "spikeloop/core/error.hpp"
#include "spikeloop/launch/programs.hpp"
#include "spikeloop/topics/names.hpp"

namespace spikeloop::app {
namespace {

constexpr const char* kNodeName = "__name";

}  // namespace

std::vector<messages::Dialect> versions_of(const experiment::Experiment& experiment) {
  if (experiment.ros == experiment::Ros::none) {
    return {};
  }
  return {experiment.dialect};
}

std::vector<messages::Dialect> versions_of(const MusicFile& file,
                                           const launch::RunOptions& options) {
  std::vector<messages::Dialect> versions;
  for (const messages::Dialect ros : {messages::Dialect::ros1, messages::Dialect::ros2}) {
    if (launch::needs_ros(file, topics::version_of(ros))) {
      versions.push_back(ros);
    }
  }
  if (options.ros && !versions.empty()) {
    versions = {topics::dialect_of(*options.ros)};
  }
  return versions;
}

void check_ros_arguments(const topics::CommandLine& line,
                         const std::vector<messages::Dialect>& versions, bool one_node) {
  if (!line.foreign.empty()) {
    throw ConfigurationError(
        fmt::format("'{}' (behind --ros-args) means nothing to a run, whose settings stand in its "
                    "file; leave it out, or end ROS's arguments by --",
                    line.foreign.front()));
  }
  if (!line.ros.empty() && versions.empty()) {
    throw ConfigurationError(
        fmt::format("'{}' is for nodes of ROS, and the file has none; leave it out",
                    topics::to_text(line.ros)));
  }
  for (const messages::Dialect ros : versions) {
    topics::check_ros_arguments(ros, line.ros);
  }
  if (const auto name = line.ros.find(kNodeName); name != line.ros.end() && !one_node) {
    throw ConfigurationError(fmt::format(
        "'{}:={}' names a node, and this run has several; leave it out", kNodeName, name->second));
  }
}

void add_ros_arguments(const topics::RosArguments& arguments, launch::JobOptions& options) {
  options.run.ros_arguments = topics::to_text(arguments);
  options.scan_topic = topics::renamed(options.scan_topic, arguments);
  for (const auto& [name, value] : arguments) {
    if (name != kNodeName) {
      options.robot_arguments.push_back(fmt::format("{}:={}", name, value));
    }
  }
}

}  // namespace spikeloop::app
