// The ROS 1 master: is there one?
#pragma once

#include <cstdint>
#include <string>

#include "spikeloop/core/time.hpp"

namespace spikeloop::ros1 {

struct MasterAddress {
  std::string host;
  std::uint16_t port = 0;
};

/// ROS_MASTER_URI, or http://localhost:11311 as everywhere in ROS 1.
std::string master_uri();

/// @throws ConfigurationError when it is no http://host:port.
MasterAddress parse_master_uri(const std::string& uri);

/// Asks the master for its process id until it answers. roscpp itself would wait for ever, and in
/// silence, so nothing of it is called before.
/// @throws TransportError with address, reason and remedy when `timeout` (wall time) has passed.
void require_master(const std::string& uri, TimeNs timeout);

}  // namespace spikeloop::ros1
