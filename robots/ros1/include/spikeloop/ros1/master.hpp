// The ROS 1 master: is there one?
#pragma once

#include <atomic>
#include <cstdint>
#include <string>

#include "spikeloop/core/time.hpp"
#include "spikeloop/topics/session.hpp"

namespace spikeloop::ros1 {

/// The environment variable that says where it is.
inline constexpr const char* kMasterVariable = "ROS_MASTER_URI";

struct MasterAddress {
  std::string host;
  std::uint16_t port = 0;
};

/// The argument __master, ROS_MASTER_URI, or http://localhost:11311 as everywhere in ROS 1.
std::string master_uri(const topics::RosArguments& arguments = {});

/// @throws ConfigurationError when it is not a http://host:port.
MasterAddress parse_master_uri(const std::string& uri);

/// Asks the master for its process id until it answers, once at least. roscpp itself would wait for
/// ever, and in silence, so nothing of it is called before.
/// @return false when `cancelled` became true before an answer
/// @throws TransportError with address, reason and remedy when `timeout` (wall time) has passed.
bool require_master(const std::string& uri, TimeNs timeout,
                    const std::atomic<bool>* cancelled = nullptr);

}  // namespace spikeloop::ros1
