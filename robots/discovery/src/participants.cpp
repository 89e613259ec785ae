#include <algorithm>
#include <charconv>
#include <fstream>
#include <set>
#include <sstream>
#include <string>

#include "cyclone_element.hpp"
#include "spikeloop/discovery/discovery.hpp"

namespace spikeloop::discovery {
namespace {

/// Local UDP ports of this network namespace.
std::set<unsigned> udp_ports() {
  std::set<unsigned> ports;
  for (const char* const path : {"/proc/net/udp", "/proc/net/udp6"}) {
    std::ifstream file(path);
    for (std::string line; std::getline(file, line);) {
      std::istringstream words(line);
      std::string number;
      std::string local;  // "0100007F:1CF2"
      words >> number >> local;
      const auto colon = local.find(':');
      unsigned port = 0;
      if (colon != std::string::npos &&
          std::from_chars(local.data() + colon + 1, local.data() + local.size(), port, 16).ec ==
              std::errc{}) {
        ports.insert(port);
      }
    }
  }
  return ports;
}

/// Ports of the DDS Interoperability Wire Protocol, section 9.6.1, for discovery by unicast. The
/// next port is for messages.
unsigned discovery_port(std::uint32_t domain, unsigned index) {
  return 7400 + 250 * domain + 10 + 2 * index;
}

constexpr unsigned kHighestPort = 65'535;

}  // namespace

unsigned most_participants(std::uint32_t domain) {
  const unsigned end = std::min(7400 + 250 * (domain + 1), kHighestPort + 1);
  return (end - discovery_port(domain, 0)) / 2;
}

std::optional<int> free_participants(const Discovery& discovery) {
  if (discovery.range == Range::off || discovery.range == Range::system_default ||
      has_element(discovery.cyclone, "ParticipantIndex")) {
    return std::nullopt;
  }
  const std::set<unsigned> taken = udp_ports();
  int free = 0;
  for (unsigned index = 0; index < most_participants(discovery.domain); ++index) {
    free += taken.contains(discovery_port(discovery.domain, index)) ? 0 : 1;
  }
  return free;
}

}  // namespace spikeloop::discovery
