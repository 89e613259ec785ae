// Other names for topics of a run: what `spikeloop run` was given for ROS.
#pragma once

#include <vector>

#include "spikeloop/config/music_file.hpp"
#include "spikeloop/experiment/experiment.hpp"
#include "spikeloop/launch/job.hpp"
#include "spikeloop/messages/dialect.hpp"
#include "spikeloop/topics/arguments.hpp"

namespace spikeloop::app {

/// The versions of ROS that a run speaks; empty: none.
std::vector<messages::Dialect> versions_of(const experiment::Experiment& experiment);
std::vector<messages::Dialect> versions_of(const MusicFile& file,
                                           const launch::RunOptions& options);

/// @param one_node all topics are one node's, which may have another name, too
/// @throws ConfigurationError for what cannot be: parameters, wrong names, no ROS.
void check_ros_arguments(const topics::CommandLine& line,
                         const std::vector<messages::Dialect>& versions, bool one_node);

/// Gives the arguments to a job's processes, and to the robot that it may start.
void add_ros_arguments(const topics::RosArguments& arguments, launch::JobOptions& options);

}  // namespace spikeloop::app
