// The listening socket of the server.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "spikeloop/processes/descriptor.hpp"

namespace spikeloop::view {

struct Accepted {
  Descriptor socket;
  std::uint32_t address = 0;  ///< IPv4 address of the client
};

/// "192.0.2.1"
std::string address_text(std::uint32_t address);

class Listener {
 public:
  /// @param port or one of the nine after it; 0: any
  /// @throws TransportError if the ports are in use, or the address is not this machine's
  Listener(const std::string& host, std::uint16_t port);

  int fd() const { return socket_.get(); }
  std::uint16_t port() const;
  /// @return nullopt if no client waits
  /// @throws TransportError if this process may open no more descriptors
  std::optional<Accepted> accept() const;

 private:
  Descriptor socket_;
};

}  // namespace spikeloop::view
