#include <algorithm>
#include <charconv>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <set>
#include <sstream>
#include <string>
#include <system_error>
#include <vector>

#include "cyclone_element.hpp"
#include "spikeloop/discovery/discovery.hpp"

namespace spikeloop::discovery {
namespace {

/// UDP sockets of this network namespace: words of each line of the kernel's table.
std::vector<std::vector<std::string>> udp_sockets() {
  std::vector<std::vector<std::string>> sockets;
  for (const char* const path : {"/proc/net/udp", "/proc/net/udp6"}) {
    std::ifstream file(path);
    std::string line;
    std::getline(file, line);  // titles
    while (std::getline(file, line)) {
      std::istringstream words(line);
      sockets.emplace_back(std::istream_iterator<std::string>(words),
                           std::istream_iterator<std::string>());
    }
  }
  return sockets;
}

// Columns of the table.
constexpr std::size_t kLocal = 1;  // "0100007F:1CF2"
constexpr std::size_t kInode = 9;
constexpr std::size_t kDrops = 12;

std::set<unsigned> udp_ports() {
  std::set<unsigned> ports;
  for (const auto& words : udp_sockets()) {
    if (words.size() <= kLocal) {
      continue;
    }
    const std::string& local = words[kLocal];
    const auto colon = local.find(':');
    unsigned port = 0;
    if (colon != std::string::npos &&
        std::from_chars(local.data() + colon + 1, local.data() + local.size(), port, 16).ec ==
            std::errc{}) {
      ports.insert(port);
    }
  }
  return ports;
}

/// "socket:[12345]" of every open socket.
std::set<std::string> own_sockets() {
  std::set<std::string> sockets;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator("/proc/self/fd", error)) {
    sockets.insert(std::filesystem::read_symlink(entry.path(), error).string());
  }
  return sockets;
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

std::uint64_t dropped_packets() {
  const std::set<std::string> own = own_sockets();
  std::uint64_t dropped = 0;
  for (const auto& words : udp_sockets()) {
    if (words.size() > kDrops && own.contains("socket:[" + words[kInode] + "]")) {
      dropped += std::strtoull(words[kDrops].c_str(), nullptr, 10);
    }
  }
  return dropped;
}

}  // namespace spikeloop::discovery
