// Requests to a node or the master with a deadline, which those of roscpp do not have.
#pragma once

#include <sys/socket.h>

#include <atomic>
#include <cstdint>
#include <map>
#include <optional>
#include <string>

#include "spikeloop/core/time.hpp"
#include "spikeloop/ros1/master.hpp"

namespace spikeloop::ros1 {

using Address = MasterAddress;

/// Parses "http://robot:45123/". @return nullopt if the text has another form
std::optional<Address> parse_uri(const std::string& uri);

/// Reason for a missing answer.
struct Fault {
  enum class Kind {
    unresolved,     ///< the host name has no address
    ipv6_only,      ///< it has IPv6 addresses only, which this node does not use (ROS_IPV6)
    silent,         ///< no connection, or no answer in time
    other_program,  ///< the answer is not that of a node or master
  };
  Kind kind;
  std::string reason;  ///< "Connection refused"
};

struct Limit {
  TimeNs deadline;                               ///< wall time, as wall_now()
  const std::atomic<bool>* cancelled = nullptr;  ///< nullptr: the request cannot be cancelled
  bool ipv6 = true;                              ///< also connects to IPv6 addresses
};

/// Calls getPid, which master and nodes have. @return nullopt if there was an answer
std::optional<Fault> ask_for_pid(const Address& address, const Limit& limit);
/// Requests the connection header of a publisher (`type`, `md5sum`, `callerid`...) at the address
/// of its messages. Publishers of every type answer. @return nullopt if there was an answer
std::optional<Fault> ask_for_header(const Address& address, const Limit& limit,
                                    const std::string& self, const std::string& topic,
                                    std::map<std::string, std::string>& header);

/// Port of one side of a TCP connection: ::getsockname: this side; ::getpeername: the other side. 0
/// if the file is not a TCP connection.
std::uint16_t port_of(int socket, int (*name)(int, sockaddr*, socklen_t*) noexcept);

/// True for 'localhost' and addresses that no other machine reaches.
bool is_loopback(const std::string& host);
/// IP address of this machine on the route to another one. Empty if the address belongs to this
/// machine. Resolves the host name without a time limit.
std::string own_address_towards(const Address& address);

}  // namespace spikeloop::ros1
