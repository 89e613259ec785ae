// The two ROS 1 adapters as MUSIC programs.
#pragma once

#include "spikeloop/process/music_main.hpp"
#include "spikeloop/ros1/session.hpp"

namespace spikeloop {

music::ProgramText sensor_text();
int run_sensor(music::Process& process);

music::ProgramText command_text();
int run_command(music::Process& process);

/// Keys that both have.
std::vector<ParameterDescription> connection_parameters(const std::string& default_node_name);
/// A name that the file gives is taken as it is; the default gets a suffix of its own, so that a
/// second adapter does not end the first one.
ros1::SessionSettings session_settings(const Parameters& parameters);
/// @throws ConfigurationError when the file gives no topic.
std::string required_topic(const music::Process& process, const Parameters& parameters,
                           const std::string& example);

}  // namespace spikeloop
