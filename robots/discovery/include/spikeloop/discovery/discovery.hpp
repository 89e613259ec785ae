// Where a process of ROS 2 looks for others, as ROS's variables of the environment say it.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace spikeloop::discovery {

/// Variables of the environment with their values; one that is not set is not there.
using Variables = std::map<std::string, std::string>;

/// How far automatic discovery goes.
enum class Range : std::uint8_t {
  subnet,         ///< this machine and its network: ROS 2's default
  localhost,      ///< this machine
  off,            ///< nobody, not on this machine either
  system_default  ///< what Cyclone DDS and CYCLONEDDS_URI say
};

struct Discovery {
  std::uint32_t domain = 0;  ///< ROS_DOMAIN_ID, 0 ... 232
  Range range = Range::subnet;
  std::vector<std::string> peers{};  ///< ROS_STATIC_PEERS: machines beyond that range
  std::string cyclone{};             ///< CYCLONEDDS_URI: settings of Cyclone DDS, the last word
  std::string distribution{};        ///< ROS_DISTRO: "humble", "jazzy"...
};

/// The environment's variables that parse() reads.
Variables environment();

/// ROS_DOMAIN_ID, ROS_AUTOMATIC_DISCOVERY_RANGE, ROS_STATIC_PEERS, ROS_LOCALHOST_ONLY,
/// CYCLONEDDS_URI and ROS_DISTRO. As in ROS 2, ROS_LOCALHOST_ONLY=1 wins over range and peers, and
/// only the ranges subnet and localhost have peers.
/// @throws ConfigurationError for a value that is none.
Discovery parse(const Variables& variables);

/// This machine as others see it.
struct Interfaces {
  std::string loopback = "lo";
  std::vector<std::string> addresses{};  ///< IPv4, of the other interfaces that are up
};
Interfaces interfaces();

/// Largest number of participants of a domain on one machine: each takes two UDP ports, and the
/// ports of the next domain follow after 250. Nodes of other DDS meet them by multicast, or because
/// Spikeloop's nodes look for them, which try all of these ports. The rmw layers try 33 of them.
unsigned most_participants(std::uint32_t domain);

/// Participants that can still start on this machine in the domain. nullopt if `discovery` does not
/// use these ports.
std::optional<int> free_participants(const Discovery& discovery);

/// Packets that this process has lost since its start because the receive buffers of its UDP
/// sockets were full. 0 if the kernel does not report it.
std::uint64_t dropped_packets();

/// Settings of Cyclone DDS (XML, then CYCLONEDDS_URI) that meet what the rmw layers of ROS 2 meet
/// in the same range, whichever DDS they run on. For all but system_default this process's port is
/// one of those that the others try.
/// @param cyclone_domain the domain's number within this process; others meet it by
/// `discovery.domain`
std::string cyclone_settings(const Discovery& discovery, const Interfaces& machine,
                             std::uint32_t cyclone_domain);

}  // namespace spikeloop::discovery
