// The master of ROS 1.
#pragma once

#include <atomic>
#include <cstdint>
#include <string>

#include "spikeloop/core/time.hpp"
#include "spikeloop/topics/session.hpp"

namespace spikeloop::ros1 {

/// Environment variable with the URI of the master.
inline constexpr const char* kMasterVariable = "ROS_MASTER_URI";

struct MasterAddress {
  std::string host;
  std::uint16_t port = 0;
};

/// URI of the master: the argument __master, else ROS_MASTER_URI, else http://localhost:11311, the
/// default of ROS 1.
std::string master_uri(const topics::RosArguments& arguments = {});

/// @throws ConfigurationError if the text is not http://HOST:PORT.
MasterAddress parse_master_uri(const std::string& uri);

/// Requests the process id of the master until it answers, at least once. roscpp itself would wait
/// without limit and without a message; so call no function of roscpp before.
/// @return false if `cancelled` became true before an answer
/// @throws TransportError with address, reason and remedy after `timeout` (wall time).
bool require_master(const std::string& uri, TimeNs timeout,
                    const std::atomic<bool>* cancelled = nullptr);

}  // namespace spikeloop::ros1
