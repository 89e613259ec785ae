// The two ZeroMQ adapters as MUSIC programs.
#pragma once

#include <string>
#include <vector>

#include "spikeloop/process/music_main.hpp"

namespace spikeloop {

music::ProgramText zmq_sensor_text();
int run_zmq_sensor(music::Process& process);

music::ProgramText zmq_command_text();
int run_zmq_command(music::Process& process);

/// `message_type`, which must be given.
/// @throws ConfigurationError naming the choices when it is missing or another one
const std::string& required_type(const music::Process& process, const Parameters& parameters,
                                 const std::vector<std::string>& choices);

}  // namespace spikeloop
