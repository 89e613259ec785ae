// An experiment as a .music file: the separate layout, a process a node; and the fused one of an
// experiment with simulators, a process for each of these and one for all other nodes.
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

/// A port of the process that has all nodes but the simulators: "brain__in" leads to the port `in`
/// of the simulator `brain`.
std::string fused_port(const std::string& end);

/// @param experiment as with_fused_delays() gives it; has a simulator
/// @param keys of the section that has all other nodes, beside those that the experiment gives it
/// @throws ConfigurationError when MUSIC cannot do it: nothing joins the simulators with the other
/// nodes, different delays into one simulator.
MusicJob fused_job(const Experiment& experiment, const std::string& folder,
                   const std::map<std::string, std::string>& keys);

/// By how many ticks a connection between a simulator and the other nodes is delayed in their
/// process; MUSIC has the rest.
std::uint32_t fused_edge_delay(const Experiment& experiment, const Link& link);

}  // namespace spikeloop::experiment
