// MPI, cores, shared memory, ROS and drawing.
#include <dlfcn.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <sched.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>

#include "../resources.hpp"
#include "probe.hpp"
#include "spikeloop/core/error.hpp"
#include "spikeloop/discovery/discovery.hpp"
#include "spikeloop/launch/mpirun.hpp"
#include "spikeloop/launch/ros_master.hpp"
#include "spikeloop/processes/python.hpp"

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
          missing("cannot start programs: ",
                  "see what it prints: mpirun -np 2 --oversubscribe hostname"),
          {mpirun, "-np", "2", "--oversubscribe", "--bind-to", "none",
           own_directory() + "/spikeloop", "--version"},
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
  const std::string unresolved = master.unresolved();
  if (unresolved.empty() && master.answers()) {
    return ok(fmt::format("answers at {}", master.uri()));
  }
  return warning(unresolved.empty() ? fmt::format("no master answers at {}", master.uri())
                                    : unresolved);
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

/// Resolved as that of a master is; nobody is asked there.
Finding look_at_host() {
  const std::string host = announced_host();
  const std::string unresolved = launch::RosMaster(fmt::format("http://{}:1", host)).unresolved();
  return unresolved.empty() ? ok(fmt::format("'{}' has an address", host)) : warning(unresolved);
}

/// Where a node of ROS 2 that starts here would look for others.
Finding ros2_discovery() {
  try {
    const discovery::Discovery found = discovery::parse(discovery::environment());
    constexpr std::array kRanges{"this machine and its network", "this machine", "nobody",
                                 "as in CYCLONEDDS_URI"};  // by Range
    std::vector<std::string> where{fmt::format("domain {}", found.domain),
                                   kRanges[static_cast<std::size_t>(found.range)]};
    if (found.range == discovery::Range::subnet) {
      const auto addresses = discovery::interfaces().addresses;
      where[1] += addresses.empty() ? " (none)" : fmt::format(" ({})", fmt::join(addresses, ", "));
    }
    where.insert(where.end(), found.peers.begin(), found.peers.end());
    if (!found.cyclone.empty()) {
      where.emplace_back("with CYCLONEDDS_URI");
    }
    return ok(fmt::format("{}", fmt::join(where, ", ")));
  } catch (const Error& error) {
    return warning(error.what(), "docs/ros2.md has these variables");
  }
}

/// The experiment of `spikeloop new` over ROS 2, in the layout separate: sensor, command, guard and
/// robot are participants.
constexpr RunNeeds kExample{.programs = 6, .feeds = 6, .participants = 4};

Finding finding_of(const Resource& resource) {
  return resource.remedy.empty() ? ok(resource.text) : warning(resource.text, resource.remedy);
}

Finding ros2_participants() {
  try {
    const Resource resource = participants(kExample);
    return resource.text.empty() ? ok("not limited by ports") : finding_of(resource);
  } catch (const Error& error) {
    return warning(error.what(), "docs/ros2.md has these variables");
  }
}

/// A library that is opened when a picture is drawn.
Probe drawing_probe(const char* name, const char* file, const char* purpose, const char* remedy) {
  return apart(name, false, missing("", remedy), [=] {
    return ::dlopen(file, RTLD_NOW) == nullptr
               ? missing(fmt::format("cannot {}: {}", purpose, ::dlerror()))
               : ok(fmt::format("{}, to {}", file, purpose));
  });
}

std::vector<Probe> drawing_probes() {
  const std::string ffmpeg = in_path("ffmpeg");
  return {drawing_probe("EGL", "libEGL.so.1", "draw cameras and films without a display",
                        "apt-get install libegl1 libgl1 libgl1-mesa-dri"),
          drawing_probe("GLFW", "libglfw.so.3", "open a window with --view",
                        "apt-get install libglfw3"),
          {"ffmpeg", false,
           ffmpeg.empty() ? missing(not_in_path("ffmpeg") + ", to make films with --render",
                                    "apt-get install ffmpeg")
                          : ok(ffmpeg + ", to make films with --render")}};
}

}  // namespace

Finding shared_memory(const std::string& directory) {
  if (access(directory.c_str(), W_OK | X_OK) != 0) {
    return warning(
        fmt::format("{}: {}; jobs use /tmp, which may be a disk", directory, std::strerror(errno)),
        fmt::format("mount -t tmpfs tmpfs {}", directory));
  }
  return finding_of(app::shared_memory(directory, kExample));
}

std::vector<Probe> machine_probes() {
  const std::string rosmaster = in_path("rosmaster");
  std::vector<Probe> probes{
      {"cores", false, cores()},
      {"shared memory", false, shared_memory("/dev/shm")},
      {"open files", false, finding_of(open_files(kExample))},
      {"address space", false, finding_of(address_space(kExample))},
      {"ROS 1", false,
       rosmaster.empty() ? missing(not_in_path("rosmaster"), kInstallRos) : ok(rosmaster)},
      apart("ROS master", false, warning("", kStartMaster), look_at_master),
      apart("host name", false, warning("", kNameHost), look_at_host),
      {"ROS 2 discovery", false, ros2_discovery()},
      {"ROS 2 participants", false, ros2_participants()}};
  const std::vector<Probe> drawing = drawing_probes();
  probes.insert(probes.end(), drawing.begin(), drawing.end());
  if (const std::string mpirun = in_path("mpirun"); !mpirun.empty()) {
    probes.push_back(mpirun_probe(mpirun));
  }
  return probes;
}

}  // namespace spikeloop::app::doctor
