#include "spikeloop/status/signals.hpp"

#include <pthread.h>
#include <signal.h>
#include <sys/prctl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <mutex>
#include <ranges>
#include <thread>
#include <vector>

#include "spikeloop/status/deadline.hpp"

namespace spikeloop::status {
namespace {

constexpr int kTerminated = 128 + SIGTERM;
/// A hook that waits for a network or a lock must not keep the process from ending.
constexpr std::chrono::seconds kLongestHooks{3};

std::atomic<bool> stop{false};
static_assert(std::atomic<bool>::is_always_lock_free);

struct Hooks {
  std::mutex mutex;
  std::vector<const SignalHook*> all;
};

// Never destroyed: a signal may come while the program leaves main().
Hooks& hooks() {
  static auto* const hooks = new Hooks;
  return *hooks;
}

constexpr std::array kOurSignals{SIGUSR1, SIGTERM, SIGHUP};

sigset_t our_signals() {
  sigset_t set;
  sigemptyset(&set);
  for (const int number : kOurSignals) {
    sigaddset(&set, number);
  }
  return set;
}

/// Threads older than SignalThread do not block our signals; a Python script's NumPy has some. What
/// reaches one of them goes on to the thread that waits.
std::atomic<pthread_t> waiting_thread{};
static_assert(std::atomic<pthread_t>::is_always_lock_free);

void pass_on(int number) {
  pthread_kill(waiting_thread.load(), number);
}

}  // namespace

bool stop_requested() {
  return stop.load(std::memory_order_relaxed);
}

bool is_ignored(int number) {
  struct sigaction action {};
  return sigaction(number, nullptr, &action) == 0 && action.sa_handler == SIG_IGN;
}

SignalHook::SignalHook(bool terminates, std::function<void()> action)
    : terminates_(terminates), action_(std::move(action)) {
  const std::lock_guard lock(hooks().mutex);
  hooks().all.push_back(this);
}

SignalHook::~SignalHook() {
  const std::lock_guard lock(hooks().mutex);
  std::erase(hooks().all, this);
}

void SignalHook::run_all(bool terminates) {
  const std::lock_guard lock(hooks().mutex);
  for (const SignalHook* const hook : std::views::reverse(hooks().all)) {
    if (hook->terminates_ == terminates) {
      try {
        hook->action_();
      } catch (...) {
        // One hook that fails must not keep the others from running.
      }
    }
  }
}

struct SignalThread::Impl {
  pid_t parent = getppid();
  std::atomic<bool> ending{false};
  std::thread thread;
  std::array<struct sigaction, kOurSignals.size()> before{};

  void take_over() {
    waiting_thread.store(thread.native_handle());
    struct sigaction action {};
    action.sa_handler = pass_on;
    action.sa_flags = SA_RESTART;
    for (std::size_t i = 0; i < kOurSignals.size(); ++i) {
      sigaction(kOurSignals[i], &action, &before[i]);
    }
  }
  void give_back() {
    for (std::size_t i = 0; i < kOurSignals.size(); ++i) {
      sigaction(kOurSignals[i], &before[i], nullptr);
    }
  }

  void wait() {
    const sigset_t set = our_signals();
    for (;;) {
      int number = 0;
      if (sigwait(&set, &number) != 0) {
        continue;
      }
      if (ending.load()) {
        return;
      }
      if (number == SIGUSR1) {
        stop.store(true, std::memory_order_relaxed);
        const Deadline deadline(kLongestHooks, kTerminated);
        SignalHook::run_all(false);
      } else if (number == SIGTERM || getppid() != parent) {
        const Deadline deadline(kLongestHooks, kTerminated);
        SignalHook::run_all(true);
        ::_exit(kTerminated);
      }
    }
  }
};

SignalThread::SignalThread() : impl_(std::make_unique<Impl>()) {
  const sigset_t set = our_signals();
  pthread_sigmask(SIG_BLOCK, &set, nullptr);
  impl_->thread = std::thread([this] { impl_->wait(); });
  impl_->take_over();
  // Programs end with mpirun, even when it is killed. The kernel sends this when the thread of the
  // parent that forked us ends, which need not be the parent's end: hence a signal of its own, and
  // a look at who the parent is.
  prctl(PR_SET_PDEATHSIG, SIGHUP);
  if (getppid() != impl_->parent) {
    pthread_kill(impl_->thread.native_handle(), SIGHUP);
  }
}

SignalThread::~SignalThread() {
  impl_->ending.store(true);
  impl_->give_back();
  prctl(PR_SET_PDEATHSIG, 0);
  pthread_kill(impl_->thread.native_handle(), SIGUSR1);
  impl_->thread.join();
  // They stay blocked: a signal that comes while the program ends must not change its exit code.
}

}  // namespace spikeloop::status
