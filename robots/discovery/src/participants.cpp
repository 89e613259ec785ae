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

}  // namespace

std::optional<int> free_participants(const Discovery& discovery) {
  if (discovery.range == Range::off || discovery.range == Range::system_default ||
      has_element(discovery.cyclone, "ParticipantIndex")) {
    return std::nullopt;
  }
  const std::set<unsigned> taken = udp_ports();
  int free = 0;
  for (unsigned index = 0; index < kMostParticipants; ++index) {
    // Ports of the DDS Interoperability Wire Protocol, section 9.6.1, for discovery by unicast.
    free += taken.contains(7400 + 250 * discovery.domain + 10 + 2 * index) ? 0 : 1;
  }
  return free;
}

}  // namespace spikeloop::discovery
