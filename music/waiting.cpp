// How programs wait for others of their job. Open MPI asks for a message again and again and calls
// sched_yield() in between (mpi_yield_when_idle): programs that wait take the processor from those
// that compute. `spikeloop run` preloads this sched_yield() into them: one that only waits sleeps
// in between, until a message rings its bell (bell.hpp) where it waits for one of MUSIC's.
// docs/performance.md has figures.
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

#include "bell.hpp"

namespace {

namespace bell = spikeloop::bell;

constexpr std::int64_t kMicrosecond = 1000;
/// A shorter wait only yields.
constexpr std::int64_t kYielding = 20 * kMicrosecond;
/// A longer one sleeps this part of the time that it has lasted, up to kShortSleep: it ends that
/// much later at most.
constexpr std::int64_t kPart = 4;
constexpr std::int64_t kShortSleep = 100 * kMicrosecond;
/// From 3.2 ms on this part, up to kLongestSleep.
constexpr std::int64_t kPartOfLongWait = 32;
constexpr std::int64_t kLongestSleep = 5'000 * kMicrosecond;
/// Who waits for a bell looks after this time all the same, and again when it has waited for twice
/// as long, up to kLongestSleep apart: large messages come in pieces.
constexpr std::int64_t kSleepForBell = 50 * kMicrosecond;
/// A yield that takes longer gave the processor to a program that computes: whoever yields then
/// waits for the whole time slice of each such program, and whoever sleeps goes before them.
constexpr std::int64_t kBusyYield = 1000 * kMicrosecond;
/// For so long after such a yield the machine counts as busy: a waiting program only sleeps.
constexpr std::int64_t kBusyFor = 20'000 * kMicrosecond;
constexpr std::int64_t kBusySleep = 5 * kMicrosecond;
/// A program that only waits calls again after 20 to 300 ns; after 2 us when it has slept and its
/// caches are cold, after up to 10 us when it has slept for milliseconds. After a message it has
/// more to do, and then begins another wait.
constexpr std::int64_t kOtherWork = 2 * kMicrosecond;
constexpr std::int64_t kOtherWorkWhenCold = 10 * kMicrosecond;
constexpr std::int64_t kPartOfColdWait = 1000;

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
    if (bell::has_begun() || called - yielded_ > other_work_after(yielded_ - began_)) {
      began_ = called;
      bell::ring_partner();
    }
    const std::int64_t waited = called - began_;
    if (called < busy_until_) {
      sleep(std::max(kBusySleep, sleep_after(waited)));
    } else if (waited < kYielding) {
      syscall(SYS_sched_yield);
      const std::int64_t ended = now();
      busy_until_ = ended - called > kBusyYield ? ended + kBusyFor : 0;
    } else {
      sleep(sleep_after(waited));
    }
    yielded_ = now();
    rings_ = bell::rings();  // before the program looks for its message once more
  }

 private:
  static std::int64_t other_work_after(std::int64_t waited) {
    return std::clamp(waited / kPartOfColdWait, kOtherWork, kOtherWorkWhenCold);
  }

  static std::int64_t sleep_after(std::int64_t waited) {
    if (bell::will_be_rung()) {
      return std::clamp(waited, kSleepForBell, kLongestSleep);
    }
    return std::min(waited / kPart,
                    std::clamp(waited / kPartOfLongWait, kShortSleep, kLongestSleep));
  }

  void sleep(std::int64_t length) {
    const int before = errno;
    if (!precise_) {
      // Linux ends sleeps up to 50 us late unless told otherwise.
      prctl(PR_SET_TIMERSLACK, 1000UL, 0UL, 0UL, 0UL);
      precise_ = true;
    }
    if (bell::exists()) {
      bell::sleep(rings_, length);
    } else {
      const timespec time{.tv_sec = 0, .tv_nsec = length};
      syscall(SYS_clock_nanosleep, CLOCK_MONOTONIC, 0, &time, nullptr);
    }
    errno = before;
  }

  std::int64_t began_ = 0;
  std::int64_t yielded_ = 0;
  std::int64_t busy_until_ = 0;
  std::uint32_t rings_ = 0;
  bool precise_ = false;
};

}  // namespace

extern "C" int sched_yield() noexcept {
  static thread_local Waiting waiting;
  waiting.yield();
  return 0;
}
