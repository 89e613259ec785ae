#include "spikeloop/command/watch.hpp"

#include <poll.h>
#include <pthread.h>
#include <signal.h>
#include <sys/eventfd.h>
#include <sys/signalfd.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstring>
#include <string>
#include <thread>

#include "spikeloop/core/code.hpp"
#include "spikeloop/core/error.hpp"
#include "spikeloop/core/pacer.hpp"
#include "spikeloop/core/priority.hpp"
#include "spikeloop/processes/descriptor.hpp"

namespace spikeloop::command {
namespace {

sigset_t watched_signals() {
  sigset_t set;
  sigemptyset(&set);
  sigaddset(&set, SIGCONT);
  sigaddset(&set, SIGINT);
  return set;
}

int checked(int result, const char* action) {
  if (result < 0) {
    const int reason = errno;  // before a string below may change it
    throw TransportError(with_code(Code::no_access,
                                   "cannot watch the robot's commands: {} failed: {}; raise the "
                                   "limit of open files (ulimit -n)",
                                   action, std::strerror(reason)));
  }
  return result;
}

constexpr TimeNs kResting = kNever;

}  // namespace

struct Watch::Impl {
  Impl(TimeNs limit, Actions to_do)
      : timeout(limit),
        actions(std::move(to_do)),
        signals(open_signals()),
        wakeup(checked(eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK), "eventfd")) {}

  static int open_signals() {
    const sigset_t set = watched_signals();
    return checked(signalfd(-1, &set, SFD_CLOEXEC | SFD_NONBLOCK), "signalfd");
  }

  void wake() const {
    const std::uint64_t one = 1;
    // write() fails only if the counter is full. The descriptor is then readable, too, and wakes
    // the thread.
    [[maybe_unused]] const auto written = ::write(wakeup.get(), &one, sizeof one);
  }

  void run() {
    run_before_others();
    while (!ending.load()) {
      const TimeNs now = wall_now();
      const TimeNs deadline = std::min({check_ticks(now), send_due(now), beat_due(now)});
      // From now on, a heartbeat with an earlier time wakes this thread.
      sleeping_until.store(deadline);
      if (!silent.load() && due.load() < deadline) {
        continue;
      }
      wait(deadline);
    }
  }

  /// Stops the robot if the loop is silent. Returns the time of the next check.
  TimeNs check_ticks(TimeNs now) {
    const TimeNs beat = last_beat.load();
    if (beat == kResting || silent.load()) {
      return kNever;
    }
    if (now - beat <= timeout) {
      return beat + timeout + 1;
    }
    silent.store(true);
    actions.stop(StopReason::silent);
    return kNever;
  }

  TimeNs send_due(TimeNs now) {
    if (silent.load()) {
      return kNever;
    }
    TimeNs next = due.load();
    if (next <= now) {
      const TimeNs again = actions.poll(now);
      // A heartbeat may have set another time meanwhile, which has priority.
      if (due.compare_exchange_strong(next, again)) {
        next = again;
      }
    }
    return next;
  }

  /// Beats are sent even if the loop is silent: they show that this thread runs.
  TimeNs beat_due(TimeNs now) {
    if (next_beat <= now) {
      next_beat = actions.beat ? actions.beat(now) : kNever;
    }
    return next_beat;
  }

  void wait(TimeNs deadline) {
    pollfd descriptors[2] = {{signals.get(), POLLIN, 0}, {wakeup.get(), POLLIN, 0}};
    timespec left{};
    if (deadline != kNever) {
      const TimeNs nanoseconds = std::max<TimeNs>(0, deadline - wall_now());
      left = {nanoseconds / kNsPerSecond, nanoseconds % kNsPerSecond};
    }
    ::ppoll(descriptors, 2, deadline == kNever ? nullptr : &left, nullptr);
    std::uint64_t count = 0;
    [[maybe_unused]] const auto drained = ::read(wakeup.get(), &count, sizeof count);
    signalfd_siginfo signal{};
    while (::read(signals.get(), &signal, sizeof signal) == sizeof signal) {
      if (signal.ssi_signo == SIGCONT) {
        actions.stop(StopReason::continued);
      } else if (actions.interrupted) {
        actions.interrupted();
      }
    }
  }

  TimeNs timeout;
  Actions actions;
  Descriptor signals;
  Descriptor wakeup;
  std::atomic<bool> ending{false};
  std::atomic<bool> silent{false};
  std::atomic<TimeNs> last_beat{kResting};
  std::atomic<TimeNs> due{kNever};
  std::atomic<TimeNs> sleeping_until{kNever};
  TimeNs next_beat = 0;  ///< used by the thread only
  std::thread thread;
};

void Watch::block_signals() {
  const sigset_t set = watched_signals();
  pthread_sigmask(SIG_BLOCK, &set, nullptr);
}

void Watch::release_signals() {
  const sigset_t set = watched_signals();
  pthread_sigmask(SIG_UNBLOCK, &set, nullptr);
}

Watch::Watch(TimeNs timeout, Actions actions)
    : impl_(std::make_unique<Impl>(timeout, std::move(actions))) {
  impl_->thread = std::thread([this] { impl_->run(); });
}

Watch::~Watch() {
  impl_->ending.store(true);
  impl_->wake();
  impl_->thread.join();
}

void Watch::heartbeat(TimeNs next_due) {
  const bool was_resting = impl_->last_beat.exchange(wall_now()) == kResting;
  const bool was_silent = impl_->silent.exchange(false);
  impl_->due.store(next_due);
  // A later deadline needs no wake-up: the thread computes it when the current one has passed.
  if (was_resting || was_silent || next_due < impl_->sleeping_until.load()) {
    impl_->wake();
  }
}

void Watch::rest() {
  impl_->last_beat.store(kResting);
  impl_->due.store(kNever);
}

}  // namespace spikeloop::command
