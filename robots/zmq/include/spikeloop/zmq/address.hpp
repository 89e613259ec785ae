// Addresses of ZeroMQ sockets.
#pragma once

#include <string>

namespace spikeloop::zmq {

/// @throws ConfigurationError unless it is tcp://HOST:PORT or ipc://PATH.
void check_address(const std::string& address);

}  // namespace spikeloop::zmq
