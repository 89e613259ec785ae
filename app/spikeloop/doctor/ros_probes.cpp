// ROS 1, and what ROS 2 needs.
#include <dlfcn.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <netdb.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cstdlib>
#include <memory>

#include "self.hpp"
#include "spikeloop/core/error.hpp"
#include "spikeloop/discovery/discovery.hpp"
#include "spikeloop/launch/ros_master.hpp"

namespace spikeloop::app::doctor {
namespace {

constexpr const char* kInstallRos = "apt-get install python3-rosmaster, or source ROS's setup.bash";
constexpr const char* kStartMaster =
    "roscore, or spikeloop run FILE --roscore; or set ROS_MASTER_URI to where one is";
constexpr const char* kHostRemedy = "see /etc/hosts; or set ROS_IP to this machine's address";

Finding ros_tools() {
  const std::string rosmaster = in_path("rosmaster");
  return rosmaster.empty() ? missing("no rosmaster in PATH", kInstallRos) : ok(rosmaster);
}

/// What the nodes of this machine tell others to call them by.
std::string announced_host() {
  for (const char* variable : {"ROS_HOSTNAME", "ROS_IP"}) {
    const char* const value = std::getenv(variable);
    if (value != nullptr && *value != '\0') {
      return value;
    }
  }
  char name[256] = "";
  gethostname(name, sizeof name - 1);
  return name;
}

std::string range_of(const discovery::Discovery& found, const discovery::Interfaces& machine) {
  switch (found.range) {
    case discovery::Range::subnet:
      return machine.addresses.empty() ? "this machine, which has no network"
                                       : fmt::format("this machine and its network ({})",
                                                     fmt::join(machine.addresses, ", "));
    case discovery::Range::localhost:
      return "this machine";
    case discovery::Range::off:
      return "nobody";
    case discovery::Range::system_default:
      return "what CYCLONEDDS_URI says";
  }
  return "";
}

/// Where a node of ROS 2 that starts here would look for others.
Finding discovery_environment() {
  try {
    const discovery::Discovery found = discovery::parse(discovery::environment());
    std::string text =
        fmt::format("domain {}, {}", found.domain, range_of(found, discovery::interfaces()));
    if (!found.peers.empty()) {
      text += fmt::format(", {}", fmt::join(found.peers, ", "));
    }
    if (!found.cyclone.empty()) {
      text += ", with CYCLONEDDS_URI";
    }
    return ok(text);
  } catch (const Error& error) {
    return warning(error.what(), "docs/ros2.md has these variables");
  }
}

}  // namespace

Finding look_at_master() {
  const std::string uri = launch::master_uri();
  try {
    const launch::RosMaster master(uri);
    if (const std::string unresolved = master.unresolved(); !unresolved.empty()) {
      return warning(unresolved, kStartMaster);
    }
    return master.answers() ? ok(fmt::format("answers at {}", uri))
                            : warning(fmt::format("no master answers at {}", uri), kStartMaster);
  } catch (const Error& error) {
    return warning(error.what(), kStartMaster);
  }
}

Finding look_at_host() {
  const std::string host = announced_host();
  addrinfo hints{};
  hints.ai_socktype = SOCK_STREAM;
  addrinfo* found = nullptr;
  if (const int error = getaddrinfo(host.c_str(), nullptr, &hints, &found); error != 0) {
    return warning(unresolved_host(host, gai_strerror(error)), kHostRemedy);
  }
  freeaddrinfo(found);
  return ok(fmt::format("'{}' has an address", host));
}

Finding look_at_cyclone() {
  for (const char* name : {"libddsc.so.0debian", "libddsc.so.0", "libddsc.so"}) {
    if (dlopen(name, RTLD_NOW | RTLD_LOCAL) != nullptr) {
      return ok(name);
    }
  }
  return missing("no libddsc.so", "apt-get install libddsc0debian");
}

std::vector<Probe> ros_probes() {
  const auto failed = [](const char* remedy) {
    return [remedy](const std::string& failure) { return warning(failure, remedy); };
  };
  return {fact("ROS 1", false, ros_tools),
          child_probe("ROS master", false, {"master"}, failed(kStartMaster)),
          child_probe("host name", false, {"host"}, failed(kHostRemedy)),
          child_probe("Cyclone DDS", false, {"cyclone"},
                      failed("apt-get install --reinstall libddsc0debian")),
          fact("ROS 2 discovery", false, discovery_environment)};
}

}  // namespace spikeloop::app::doctor
