#include "spikeloop/discovery/discovery.hpp"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <ifaddrs.h>
#include <net/if.h>
#include <netinet/in.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <memory>
#include <string_view>
#include <utility>

#include "cyclone_element.hpp"
#include "spikeloop/core/code.hpp"
#include "spikeloop/core/error.hpp"

namespace spikeloop::discovery {
namespace {

constexpr const char* kDomain = "ROS_DOMAIN_ID";
constexpr const char* kRange = "ROS_AUTOMATIC_DISCOVERY_RANGE";
constexpr const char* kPeers = "ROS_STATIC_PEERS";
constexpr const char* kLocalhostOnly = "ROS_LOCALHOST_ONLY";
constexpr const char* kCyclone = "CYCLONEDDS_URI";
constexpr const char* kDistribution = "ROS_DISTRO";
constexpr std::array kVariables{kDomain, kRange, kPeers, kLocalhostOnly, kCyclone, kDistribution};

constexpr std::uint32_t kHighestDomain = 232;  // beyond, there is no port for it

constexpr std::array<std::pair<const char*, Range>, 4> kRanges{
    {{"SUBNET", Range::subnet},
     {"LOCALHOST", Range::localhost},
     {"OFF", Range::off},
     {"SYSTEM_DEFAULT", Range::system_default}}};

std::string value_of(const Variables& variables, const char* name) {
  const auto found = variables.find(name);
  return found == variables.end() ? std::string() : found->second;
}

std::uint32_t parse_domain(const std::string& text) {
  if (text.empty()) {
    return 0;
  }
  std::uint32_t domain = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), domain);
  if (error != std::errc{} || end != text.data() + text.size() || domain > kHighestDomain) {
    throw ConfigurationError(with_code(
        Code::ros_setting,
        "ROS_DOMAIN_ID is '{}', which is not a domain of ROS 2; write a whole number from "
        "0 to {}",
        text, kHighestDomain));
  }
  return domain;
}

Range parse_range(const std::string& text) {
  if (text.empty()) {
    return Range::subnet;
  }
  const auto found = std::find_if(kRanges.begin(), kRanges.end(),
                                  [&](const auto& range) { return text == range.first; });
  if (found == kRanges.end()) {
    throw ConfigurationError(
        with_code(Code::ros_setting,
                  "ROS_AUTOMATIC_DISCOVERY_RANGE is '{}'; write SUBNET, LOCALHOST, OFF or "
                  "SYSTEM_DEFAULT",
                  text));
  }
  return found->second;
}

bool parse_localhost_only(const std::string& text) {
  if (!text.empty() && text != "0" && text != "1") {
    throw ConfigurationError(
        with_code(Code::ros_setting,
                  "ROS_LOCALHOST_ONLY is '{}'; write 1 for this machine alone, or 0", text));
  }
  return text == "1";
}

std::vector<std::string> parse_peers(const std::string& text) {
  std::vector<std::string> peers;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find(';', begin), text.size());
    std::string peer = text.substr(begin, end - begin);
    begin = end + 1;
    if (peer.empty()) {
      continue;
    }
    if (peer.find_first_of(" \t\n,<>&\"'") != std::string::npos) {
      throw ConfigurationError(
          with_code(Code::ros_setting,
                    "ROS_STATIC_PEERS has '{}', which is not an address; write host names or IP "
                    "addresses with ';' between them",
                    peer));
    }
    peers.push_back(std::move(peer));
  }
  return peers;
}

std::string element(const std::string& name, const std::string& text) {
  return fmt::format("<{0}>{1}</{0}>", name, text);
}

std::string peer_list(const std::vector<std::string>& addresses) {
  std::string list;
  for (const std::string& address : addresses) {
    list += fmt::format("<Peer address=\"{}\"/>", address);
  }
  return element("Peers", list);
}

/// The network's interface and this machine's own: Fast DDS announces the former's address alone
/// when it is told to stay on the machine, Cyclone DDS the latter's. Linux does not say that `lo`
/// can multicast; Cyclone would then do without it everywhere.
///
/// Cyclone 0.10 tries peers from the interface of the highest priority alone, which is `lo` unless
/// we say another; nothing leaves the machine from there. Without peers `lo` is better: nodes of
/// this machine then hear each other when the network has gone.
std::string interface_list(const Interfaces& machine, bool peers) {
  std::string list;
  if (!machine.addresses.empty()) {
    list = fmt::format(R"(<NetworkInterface autodetermine="true"{}/>)",
                       peers ? R"( priority="1")" : "");
  }
  list += fmt::format(R"(<NetworkInterface name="{}" multicast="true"{}/>)", machine.loopback,
                      peers ? R"( priority="0")" : "");
  return element("Interfaces", list);
}

std::string contents_of(const std::string& path) {
  std::ifstream in(path);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// Cyclone DDS would add a user's interfaces to ours, and refuse one that is there twice.
bool names_interfaces(const std::string& cyclone) {
  return has_element(cyclone, "NetworkInterface");
}

/// Peers that keep to a machine try each other's well-known ports. Newer ones of Cyclone hear only
/// what comes over the interface that they chose, so the machine's other addresses are tried, too.
std::string meeting(const Discovery& discovery, const Interfaces& machine) {
  std::vector<std::string> peers{"127.0.0.1"};
  peers.insert(peers.end(), machine.addresses.begin(), machine.addresses.end());
  peers.insert(peers.end(), discovery.peers.begin(), discovery.peers.end());
  const char* multicast = discovery.range == Range::subnet ? "spdp" : "false";
  const std::string chosen = names_interfaces(discovery.cyclone)
                                 ? std::string()
                                 : interface_list(machine, !discovery.peers.empty());
  return element("General", chosen + element("AllowMulticast", multicast)) +
         element("Discovery", element("ParticipantIndex", "auto") +
                                  element("MaxAutoParticipantIndex",
                                          fmt::to_string(most_participants(discovery.domain) - 1)) +
                                  peer_list(peers));
}

/// Only who has the same tag is met.
std::string meeting_nobody() {
  return element("General", element("AllowMulticast", "false")) +
         element("Discovery", element("ParticipantIndex", "none") +
                                  element("Tag", fmt::format("spikeloop_{}", ::getpid())));
}

/// A writer never waits for a slow subscriber: its queue bounds what it keeps. Fast DDS takes leave
/// of a node by the hash of its key alone; without it the node stays in the graph until its lease
/// ends. A publisher on Fast DDS that leaves 100 ms after its only message (`ros2 topic pub
/// --once`) would be gone before a missing message is asked for again, by default after 100 ms and
/// 3 s. MultipleReceiveThreads is false: at shutdown Cyclone DDS wakes a per-socket thread by a
/// packet, which fails without a network, but the common thread by a pipe.
constexpr const char* kDelivery =
    "<Internal><Watermarks><WhcAdaptive>false</WhcAdaptive><WhcHighInit>1 GB</WhcHighInit>"
    "<WhcHigh>1 GB</WhcHigh></Watermarks>"
    R"(<SocketReceiveBufferSize max="8 MB"/><GenerateKeyhash>true</GenerateKeyhash>)"
    "<NackDelay>20 ms</NackDelay><AutoReschedNackDelay>20 ms</AutoReschedNackDelay>"
    "<MultipleReceiveThreads>false</MultipleReceiveThreads></Internal>";

}  // namespace

bool has_element(const std::string& cyclone, std::string_view element) {
  constexpr std::string_view kFile = "file://";
  bool found = cyclone.find(element) != std::string::npos;
  for (std::size_t begin = 0; begin < cyclone.size() && !found;) {
    const std::size_t end = std::min(cyclone.find(',', begin), cyclone.size());
    std::string part = cyclone.substr(begin, end - begin);
    part.erase(0, part.starts_with(kFile) ? kFile.size() : 0);
    found = !part.starts_with('<') && contents_of(part).find(element) != std::string::npos;
    begin = end + 1;
  }
  return found;
}

Variables environment() {
  Variables variables;
  for (const char* name : kVariables) {
    if (const char* value = std::getenv(name); value != nullptr) {
      variables[name] = value;
    }
  }
  return variables;
}

Discovery parse(const Variables& variables) {
  Discovery result{.domain = parse_domain(value_of(variables, kDomain)),
                   .range = parse_range(value_of(variables, kRange)),
                   .peers = parse_peers(value_of(variables, kPeers)),
                   .cyclone = value_of(variables, kCyclone),
                   .distribution = value_of(variables, kDistribution)};
  if (parse_localhost_only(value_of(variables, kLocalhostOnly))) {
    result.range = Range::localhost;
    result.peers.clear();
  }
  if (result.range == Range::off || result.range == Range::system_default) {
    result.peers.clear();
  }
  return result;
}

Interfaces interfaces() {
  Interfaces machine;
  ifaddrs* list = nullptr;
  if (::getifaddrs(&list) != 0) {
    return machine;
  }
  const std::unique_ptr<ifaddrs, decltype(&::freeifaddrs)> owner(list, &::freeifaddrs);
  for (const ifaddrs* entry = list; entry != nullptr; entry = entry->ifa_next) {
    if (entry->ifa_addr == nullptr || entry->ifa_addr->sa_family != AF_INET ||
        (entry->ifa_flags & IFF_UP) == 0) {
      continue;
    }
    std::array<char, INET_ADDRSTRLEN> text{};
    ::inet_ntop(AF_INET, &reinterpret_cast<const sockaddr_in*>(entry->ifa_addr)->sin_addr,
                text.data(), text.size());
    if ((entry->ifa_flags & IFF_LOOPBACK) != 0) {
      machine.loopback = entry->ifa_name;
    } else {
      machine.addresses.emplace_back(text.data());
    }
  }
  return machine;
}

std::string cyclone_settings(const Discovery& discovery, const Interfaces& machine,
                             std::uint32_t cyclone_domain) {
  std::string settings = kDelivery;
  if (discovery.range == Range::off) {
    settings += meeting_nobody();
  } else if (discovery.range != Range::system_default) {
    settings += meeting(discovery, machine);
  }
  if (cyclone_domain != discovery.domain) {
    settings += element("Discovery", element("ExternalDomainId", fmt::to_string(discovery.domain)));
  }
  const std::string xml = element("CycloneDDS", element("Domain", settings));
  return discovery.cyclone.empty() ? xml : xml + "," + discovery.cyclone;
}

}  // namespace spikeloop::discovery
