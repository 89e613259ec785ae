// Addresses of ZeroMQ sockets, as the key zmq_addr says them.
#pragma once

#include <string>

namespace spikeloop::zmq {

/// @throws ConfigurationError unless one can connect to it: tcp://HOST:PORT or ipc://PATH.
void check_connect_address(const std::string& address);

/// @throws ConfigurationError unless one can publish at it: tcp://IP:PORT, tcp://INTERFACE:PORT,
/// tcp://*:PORT or ipc://PATH, where PATH is none of something else than a socket.
void check_bind_address(const std::string& address);

}  // namespace spikeloop::zmq
