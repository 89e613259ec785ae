// How programs wait for others of their job. Open MPI asks for a message again and again and calls
// sched_yield() in between (mpi_yield_when_idle): programs that wait take the processor from those
// that compute. `spikeloop run` preloads this sched_yield() into them: one that has only waited for
// 1 ms sleeps in between. docs/performance.md has figures.

#include <sched.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <chrono>
#include <thread>

namespace spikeloop::process {
namespace {

using Clock = std::chrono::steady_clock;
using std::chrono::microseconds;

/// A shorter wait only yields. As long as a short tick: a program with much to compute in each
/// never sleeps.
constexpr Clock::duration kYielding = microseconds{1000};
/// What a program does in between if it only waits; whatever takes longer ends the wait.
constexpr Clock::duration kPause = microseconds{50};
/// A message is seen later by no more than this, and what the scheduler adds.
constexpr Clock::duration kSleep = microseconds{100};

class Waiting {
 public:
  void yield() {
    const Clock::time_point now = Clock::now();
    if (now - yielded_ > kPause) {
      began_ = now;
    }
    if (now - began_ < kYielding) {
      syscall(SYS_sched_yield);
    } else {
      sleep();
    }
    yielded_ = Clock::now();
  }

 private:
  void sleep() {
    if (!precise_) {
      // Linux ends sleeps up to 50 us late unless told otherwise.
      prctl(PR_SET_TIMERSLACK, 1000UL, 0UL, 0UL, 0UL);
      precise_ = true;
    }
    std::this_thread::sleep_for(kSleep);
  }

  Clock::time_point began_;
  Clock::time_point yielded_;
  bool precise_ = false;
};

}  // namespace
}  // namespace spikeloop::process

extern "C" int sched_yield() noexcept {
  thread_local spikeloop::process::Waiting waiting;
  waiting.yield();
  return 0;
}
