#include "spikeloop/processes/trial.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <signal.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <mutex>
#include <new>
#include <set>
#include <stdexcept>
#include <thread>

#include "reset_signals.hpp"
#include "spikeloop/core/code.hpp"
#include "spikeloop/core/error.hpp"
#include "spikeloop/core/log.hpp"
#include "spikeloop/processes/descendants.hpp"

namespace spikeloop {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

constexpr std::uint64_t kSeconds = 4;
constexpr std::uint64_t kBytesASecond = 20'000'000;
constexpr rlim_t kMemory = 4'000'000'000;
/// A recording in memory is twice as large as its file.
constexpr rlim_t kMemoryAByte = 3;
constexpr std::chrono::milliseconds kLook{1};
constexpr int kTooLarge = 2;

/// Of this process, in bytes of addresses.
rlim_t memory() {
  std::ifstream file("/proc/self/statm");
  rlim_t pages = 0;
  file >> pages;
  return pages * static_cast<rlim_t>(sysconf(_SC_PAGESIZE));
}

/// @param process 0: this one
void set_limit(__rlimit_resource kind, rlim_t value, pid_t process = 0) {
  rlimit limit{};
  prlimit(process, kind, nullptr, &limit);
  limit.rlim_cur = std::min(value, limit.rlim_max);
  prlimit(process, kind, &limit, nullptr);
}

struct Limits {
  explicit Limits(std::uint64_t size)
      : seconds(kSeconds + size / kBytesASecond), memory(kMemory + kMemoryAByte * size) {}
  std::uint64_t seconds;
  rlim_t memory;  ///< bytes beyond what this process has
};

[[noreturn]] void be_the_copy(const Limits& limits, const std::function<void()>& work) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  reset_signals();
  const int nowhere = ::open("/dev/null", O_RDWR);
  for (const int file : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    ::dup2(nowhere, file);
  }
  log::set_level(log::Level::error);  // the caller says it all when it does the work itself
  set_limit(RLIMIT_CORE, 0);
  set_limit(RLIMIT_AS, memory() + limits.memory);
  try {
    work();
  } catch (const std::bad_alloc&) {
    _exit(kTooLarge);
  } catch (const std::length_error&) {
    _exit(kTooLarge);
  } catch (...) {
    _exit(0);
  }
  _exit(0);
}

/// Its status; SIGXCPU as for one that took too long when it hangs.
int end_of(pid_t child, std::uint64_t seconds) {
  const auto deadline = Clock::now() + std::chrono::seconds(seconds);
  int status = 0;
  for (;;) {
    const pid_t ended = waitpid(child, &status, WNOHANG);
    if (ended == child) {
      return status;
    }
    if (ended < 0 && errno != EINTR) {
      return 0;  // somebody else has waited for it
    }
    if (Clock::now() > deadline && is_sleeping(child)) {
      kill(child, SIGXCPU);
    }
    std::this_thread::sleep_for(kLook);
  }
}

void refuse(const std::string& path, std::string_view library, int status, const Limits& limits) {
  if (WIFEXITED(status) && WEXITSTATUS(status) == kTooLarge) {
    throw ConfigurationError(Location{path},
                             with_code(Code::out_of_bounds,
                                       "{} needs more than {} GB of memory for it; look for a size "
                                       "that is too large",
                                       library, limits.memory / 1'000'000'000));
  }
  const int number = WIFSIGNALED(status) ? WTERMSIG(status) : 0;
  constexpr std::array kAsked{0, SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGUSR1};
  if (std::ranges::find(kAsked, number) != kAsked.end()) {
    return;  // Ctrl-C is everybody's
  }
  if (number == SIGKILL) {
    throw FileError(with_code(Code::no_access,
                              "cannot read '{}': {} was killed; see whether there is enough memory",
                              path, library));
  }
  if (number == SIGXCPU) {
    throw FileError(with_code(Code::no_access,
                              "cannot read '{}': {} takes longer than {} s; see whether it, or "
                              "a file that it names, is damaged or a pipe",
                              path, library, limits.seconds));
  }
  throw FileError(with_code(Code::no_access, "cannot read '{}': damaged: {} crashes ({})", path,
                            library, strsignal(number)));
}

/// The same for the same contents.
std::string identity(const std::string& path, std::uint64_t size) {
  std::error_code error;
  const auto time = fs::last_write_time(path, error).time_since_epoch().count();
  return fmt::format("{}\n{}\n{}", fs::absolute(path, error).string(), size, time);
}

}  // namespace

void try_in_a_copy(const std::string& path, std::string_view library,
                   const std::function<void()>& work) {
  static std::mutex mutex;
  static std::set<std::string> tried;
  std::error_code error;
  const std::uint64_t size = fs::file_size(path, error);
  const std::string file = identity(path, error ? 0 : size);
  const std::lock_guard lock(mutex);
  if (tried.contains(file)) {
    return;
  }
  const Limits limits(error ? 0 : size);
  const pid_t child = fork();
  if (child == 0) {
    be_the_copy(limits, work);
  }
  if (child < 0) {
    throw FileError("start a process to read", path, errno);
  }
  // From here, because the copy of a process with threads may not get far enough to do it.
  set_limit(RLIMIT_CPU, limits.seconds, child);
  refuse(path, library, end_of(child, limits.seconds), limits);
  tried.insert(file);
}

}  // namespace spikeloop
