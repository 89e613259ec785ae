// MPI, cores, shared memory and ROS.
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <netdb.h>
#include <sched.h>
#include <sys/socket.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>

#include "probe.hpp"
#include "spikeloop/core/error.hpp"
#include "spikeloop/discovery/discovery.hpp"
#include "spikeloop/launch/mpirun.hpp"
#include "spikeloop/launch/ros_master.hpp"

namespace spikeloop::app::doctor {
namespace {

constexpr const char* kInstallRos = "apt-get install python3-rosmaster, or source ROS's setup.bash";
constexpr const char* kStartMaster =
    "roscore, or spikeloop run FILE --roscore; or set ROS_MASTER_URI to where one is";
constexpr const char* kNameHost = "see /etc/hosts; or set ROS_IP to this machine's address";

/// More processes than cores, as root if that is who we are, as `spikeloop run` starts them.
Probe mpirun_probe(const std::string& mpirun) {
  return {"mpirun",
          true,
          "",
          missing("cannot start programs: ",
                  "see what it prints: mpirun -np 2 --oversubscribe hostname"),
          {mpirun, "-np", "2", "--oversubscribe", "--bind-to", "none",
           launch::own_directory() + "/spikeloop", "--version"},
          [](const Answer& answer) {
            return answer.out.empty()
                       ? missing("cannot start programs: they print nothing")
                       : ok(fmt::format("started 2 processes in {:.1f} s; --oversubscribe works{}",
                                        answer.seconds, geteuid() == 0 ? ", as root too" : ""));
          }};
}

Finding cores() {
  cpu_set_t mine;
  CPU_ZERO(&mine);
  const int count = sched_getaffinity(0, sizeof mine, &mine) == 0 ? CPU_COUNT(&mine) : 1;
  return count > 1 ? ok(std::to_string(count))
                   : warning("1: the programs of a job take turns",
                             "use a machine with a core a program, or --real-time-factor 0.5");
}

Finding look_at_master() {
  const launch::RosMaster master(launch::master_uri());
  if (const std::string unresolved = master.unresolved(); !unresolved.empty()) {
    return warning(unresolved);
  }
  return master.answers() ? ok(fmt::format("answers at {}", master.uri()))
                          : warning(fmt::format("no master answers at {}", master.uri()));
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

Finding look_at_host() {
  const std::string host = announced_host();
  addrinfo hints{};
  hints.ai_socktype = SOCK_STREAM;
  addrinfo* found = nullptr;
  if (const int error = getaddrinfo(host.c_str(), nullptr, &hints, &found); error != 0) {
    return warning(unresolved_host(host, gai_strerror(error)));
  }
  freeaddrinfo(found);
  return ok(fmt::format("'{}' has an address", host));
}

std::string range_of(const discovery::Discovery& found) {
  switch (found.range) {
    case discovery::Range::subnet: {
      const auto addresses = discovery::interfaces().addresses;
      return addresses.empty()
                 ? "this machine, which has no network"
                 : fmt::format("this machine and its network ({})", fmt::join(addresses, ", "));
    }
    case discovery::Range::localhost:
      return "this machine";
    case discovery::Range::off:
      return "nobody";
    default:
      return "as in CYCLONEDDS_URI";
  }
}

/// Where a node of ROS 2 that starts here would look for others.
Finding ros2_discovery() {
  try {
    const discovery::Discovery found = discovery::parse(discovery::environment());
    std::string text = fmt::format("domain {}, {}", found.domain, range_of(found));
    for (const std::string& peer : found.peers) {
      text += ", " + peer;
    }
    return ok(text + (found.cyclone.empty() ? "" : ", with CYCLONEDDS_URI"));
  } catch (const Error& error) {
    return warning(error.what(), "docs/ros2.md has these variables");
  }
}

}  // namespace

Finding shared_memory(const std::string& directory) {
  constexpr double kEnough_MB = 128;  // Open MPI takes some 4 MB a process
  struct statvfs space {};
  if (statvfs(directory.c_str(), &space) != 0 || access(directory.c_str(), W_OK | X_OK) != 0) {
    return warning(
        fmt::format("{}: {}; jobs use /tmp, which may be a disk", directory, std::strerror(errno)),
        fmt::format("mount -t tmpfs tmpfs {}", directory));
  }
  const double free_MB =
      static_cast<double>(space.f_bavail) * static_cast<double>(space.f_frsize) / 1e6;
  const std::string text = fmt::format("{:.0f} MB free in {}", free_MB, directory);
  return free_MB >= kEnough_MB
             ? ok(text)
             : warning(text, "remove old files there; in a container: docker run --shm-size=1g");
}

std::vector<Probe> machine_probes() {
  const std::string rosmaster = in_path("rosmaster");
  std::vector<Probe> probes{
      {"cores", false, "", cores()},
      {"shared memory", false, "", shared_memory("/dev/shm")},
      {"ROS 1", false, "",
       rosmaster.empty() ? missing(not_in_path("rosmaster"), kInstallRos) : ok(rosmaster)},
      apart("ROS master", false, warning("", kStartMaster), look_at_master),
      apart("host name", false, warning("", kNameHost), look_at_host),
      {"ROS 2 discovery", false, "", ros2_discovery()}};
  if (const std::string mpirun = in_path("mpirun"); !mpirun.empty()) {
    probes.push_back(mpirun_probe(mpirun));
  }
  return probes;
}

}  // namespace spikeloop::app::doctor
