// The separate layout: an experiment as a .music file, a process a node.
#pragma once

#include <map>
#include <string>

#include "spikeloop/config/music_file.hpp"
#include "spikeloop/experiment/experiment.hpp"

namespace spikeloop::experiment {

struct MusicJob {
  MusicFile file;  ///< its paths are absolute, or start where the experiment lies
  /// What stands in the experiment itself, and has to be a file for a process: name to contents.
  /// The sections name them in the folder that music_job() was given.
  std::map<std::string, std::string> files;
};

/// Sections and connections as the experiment has them. A declared delay is kept; a continuous
/// connection without one gets what MUSIC takes, a tick.
/// @param folder where `files` will lie
/// @throws ConfigurationError for what MUSIC cannot do: lockstep, a robot without ROS, a continuous
/// connection with delay 0, different delays into one node.
MusicJob music_job(const Experiment& experiment, const std::string& folder);

}  // namespace spikeloop::experiment
