// How programs wait for others of their job. Open MPI asks for a message again and again and calls
// sched_yield() in between (mpi_yield_when_idle): programs that wait take the processor from those
// that compute. `spikeloop run` preloads this sched_yield() into them: one that only waits sleeps
// in between. docs/performance.md has figures.
//
// It enters programs of any kind: it needs libc alone (another libstdc++ may be theirs), and is
// what POSIX says of sched_yield(): no cancellation point, errno stays.

#include <sched.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <time.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdint>

namespace {

constexpr std::int64_t kMicrosecond = 1000;
/// A shorter wait only yields.
constexpr std::int64_t kYielding = 20 * kMicrosecond;
/// A longer one sleeps this part of the time that it has lasted: it ends that much later at most.
constexpr std::int64_t kPart = 4;
constexpr std::int64_t kLongestSleep = 100 * kMicrosecond;
/// A program whose waits have all been as long is idle. It sleeps as long again as it has waited,
/// for MPI looks at its sockets every 10 ms and a new wait seems to begin; this part of its idle
/// time is the most.
constexpr std::int64_t kIdle = 2'000 * kMicrosecond;
constexpr std::int64_t kPartOfIdle = 40;
constexpr std::int64_t kLongestIdleSleep = 5'000 * kMicrosecond;
/// A yield that takes longer gave the processor to a program that computes: whoever yields then
/// waits for the whole time slice of each such program, and whoever sleeps goes before them.
constexpr std::int64_t kBusyYield = 1000 * kMicrosecond;
/// For so long after such a yield the machine counts as busy: a waiting program only sleeps.
constexpr std::int64_t kBusyFor = 20'000 * kMicrosecond;
constexpr std::int64_t kBusySleep = 5 * kMicrosecond;
/// A program that only waits calls again after 20 to 300 ns, and after 2 us when it has slept and
/// its caches are cold. After a message it has more to do, and then begins another wait.
constexpr std::int64_t kOtherWork = 2 * kMicrosecond;

/// Nanoseconds.
std::int64_t now() {
  timespec time{};
  clock_gettime(CLOCK_MONOTONIC, &time);
  return time.tv_sec * std::int64_t{1'000'000'000} + time.tv_nsec;
}

class Waiting {
 public:
  void yield() {
    const std::int64_t called = now();
    if (called - yielded_ > kOtherWork) {
      if (yielded_ - began_ < kIdle) {
        idle_since_ = called;
      }
      began_ = called;
    }
    const std::int64_t waited = called - began_;
    if (called < busy_until_) {
      sleep(std::max(kBusySleep, sleep_after(waited, called - idle_since_)));
    } else if (waited < kYielding) {
      syscall(SYS_sched_yield);
      const std::int64_t ended = now();
      busy_until_ = ended - called > kBusyYield ? ended + kBusyFor : 0;
    } else {
      sleep(sleep_after(waited, called - idle_since_));
    }
    yielded_ = now();
  }

 private:
  static std::int64_t sleep_after(std::int64_t waited, std::int64_t idle) {
    return idle < kIdle
               ? std::min(waited / kPart, kLongestSleep)
               : std::min(waited, std::clamp(idle / kPartOfIdle, kLongestSleep, kLongestIdleSleep));
  }

  void sleep(std::int64_t length) {
    const int before = errno;
    if (!precise_) {
      // Linux ends sleeps up to 50 us late unless told otherwise.
      prctl(PR_SET_TIMERSLACK, 1000UL, 0UL, 0UL, 0UL);
      precise_ = true;
    }
    const timespec time{.tv_sec = 0, .tv_nsec = length};
    syscall(SYS_clock_nanosleep, CLOCK_MONOTONIC, 0, &time, nullptr);
    errno = before;
  }

  std::int64_t began_ = 0;
  std::int64_t idle_since_ = 0;
  std::int64_t yielded_ = 0;
  std::int64_t busy_until_ = 0;
  bool precise_ = false;
};

}  // namespace

extern "C" int sched_yield() noexcept {
  static thread_local Waiting waiting;
  waiting.yield();
  return 0;
}
