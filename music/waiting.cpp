// How programs wait for others of their job. Open MPI asks for a message again and again and calls
// sched_yield() in between (mpi_yield_when_idle): programs that wait take the processor from those
// that compute. `spikeloop run` preloads this sched_yield() into them: one that has only waited for
// 1 ms sleeps in between. docs/performance.md has figures.
//
// It enters programs of any kind: it needs libc alone (another libstdc++ may be theirs), and is
// what POSIX says of sched_yield(): no cancellation point, errno stays.

#include <sched.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <time.h>
#include <unistd.h>

#include <cerrno>
#include <cstdint>

namespace {

constexpr std::int64_t kMicrosecond = 1000;
/// A shorter wait only yields.
constexpr std::int64_t kYielding = 1000 * kMicrosecond;
/// What a program does in between if it only waits; whatever takes longer ends the wait.
constexpr std::int64_t kPause = 10 * kMicrosecond;
/// A message is seen later by no more than this, and what the scheduler adds.
constexpr std::int64_t kSleep = 100 * kMicrosecond;

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
    if (called - yielded_ > kPause) {
      began_ = called;
    }
    if (called - began_ < kYielding) {
      syscall(SYS_sched_yield);
    } else {
      sleep();
    }
    yielded_ = now();
  }

 private:
  void sleep() {
    const int before = errno;
    if (!precise_) {
      // Linux ends sleeps up to 50 us late unless told otherwise.
      prctl(PR_SET_TIMERSLACK, 1000UL, 0UL, 0UL, 0UL);
      precise_ = true;
    }
    const timespec time{.tv_sec = 0, .tv_nsec = kSleep};
    syscall(SYS_clock_nanosleep, CLOCK_MONOTONIC, 0, &time, nullptr);
    errno = before;
  }

  std::int64_t began_ = 0;
  std::int64_t yielded_ = 0;
  bool precise_ = false;
};

}  // namespace

extern "C" int sched_yield() noexcept {
  static thread_local Waiting waiting;
  waiting.yield();
  return 0;
}
