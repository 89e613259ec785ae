// An experiment as a .music file: with a section for each process of its layout, to be run; or with
// a program for each node, to be exported.
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

/// The job of `spikeloop export`: each node is a section of the program of its class, which users
/// of MUSIC can edit and run without an experiment file. A declared delay is kept; a continuous
/// connection without one gets what MUSIC takes, a tick.
/// @param folder where `files` will lie
/// @throws ConfigurationError for what MUSIC cannot do: lockstep, a robot without ROS, a continuous
/// connection with delay 0, different delays into one node.
MusicJob music_job(const Experiment& experiment, const std::string& folder);

/// A port of a process that has nodes: "brain__in" leads to the port `in` of the simulator `brain`.
std::string process_port(const std::string& end);

/// A section for each process of the layout, and for each simulator.
/// @param experiment as with_layout_delays() gives it
/// @param keys of every section that has nodes, beside those that the experiment gives it; `record`
/// goes to simulators, too
/// @throws ConfigurationError when MUSIC cannot do it: nothing joins a process with the others,
/// different delays into one simulator.
MusicJob process_job(const Experiment& experiment, const std::string& folder,
                     const std::map<std::string, std::string>& keys);

}  // namespace spikeloop::experiment
