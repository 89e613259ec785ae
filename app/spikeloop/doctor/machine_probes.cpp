// Cores and shared memory.
#include <fmt/format.h>
#include <sched.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "probe.hpp"

namespace spikeloop::app::doctor {
namespace {

constexpr const char* kSharedMemory = "/dev/shm";
/// Open MPI takes some 4 MB of it a process.
constexpr double kEnough_MB = 128;

Finding cores() {
  cpu_set_t mine;
  CPU_ZERO(&mine);
  const int count = sched_getaffinity(0, sizeof mine, &mine) == 0 ? CPU_COUNT(&mine) : 1;
  return count > 1 ? ok(fmt::format("{}", count))
                   : warning("1: the programs of a job take turns",
                             "use a machine with a core a program, or --real-time-factor 0.5");
}

}  // namespace

Finding shared_memory(const std::string& directory) {
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
  return {fact("cores", false, cores),
          fact("shared memory", false, [] { return shared_memory(kSharedMemory); })};
}

}  // namespace spikeloop::app::doctor
