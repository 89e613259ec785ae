// Questions to a node or the master with a deadline, unlike those of roscpp.
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

/// "http://robot:45123/". @return nullopt if it has another form
std::optional<Address> parse_uri(const std::string& uri);

/// Reason why an address gives no answer.
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
  TimeNs deadline;                               ///< of wall_now()
  const std::atomic<bool>* cancelled = nullptr;  ///< nullptr: the question cannot be cancelled
  bool ipv6 = true;                              ///< also connects to IPv6 addresses
};

/// Calls getPid, which master and nodes have. @return nullopt if there was an answer
std::optional<Fault> ask_for_pid(const Address& address, const Limit& limit);
/// Asks a publisher, at the address of its messages, for the header of a connection: `type`,
/// `md5sum`, `callerid`... Publishers of every type answer. @return nullopt if there was an answer
std::optional<Fault> ask_for_header(const Address& address, const Limit& limit,
                                    const std::string& self, const std::string& topic,
                                    std::map<std::string, std::string>& header);

/// Port of one side of a TCP connection: ::getsockname is this side, ::getpeername the other one.
/// 0 for any other file.
std::uint16_t port_of(int socket, int (*name)(int, sockaddr*, socklen_t*) noexcept);

/// True for 'localhost' and addresses that no other machine reaches.
bool is_loopback(const std::string& host);
/// IP address of this machine on the way to another one. Empty if the address is of this machine.
/// Resolves the host name without a time limit.
std::string own_address_towards(const Address& address);

}  // namespace spikeloop::ros1
