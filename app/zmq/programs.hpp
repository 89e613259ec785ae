// The two ZeroMQ adapters as MUSIC programs.
#pragma once

#include "spikeloop/process/music_main.hpp"

namespace spikeloop {

music::ProgramText zmq_sensor_text();
int run_zmq_sensor(music::Process& process);

music::ProgramText zmq_command_text();
int run_zmq_command(music::Process& process);

/// `zmq_addr`. @throws ConfigurationError for an impossible address
std::string required_address(const Parameters& parameters);

/// `message_type`, which must be given.
/// @throws ConfigurationError naming the choices when it is missing
const std::string& required_type(const music::Process& process, const Parameters& parameters,
                                 const char* choices);

}  // namespace spikeloop
