#include "spikeloop/status/signal_watch.hpp"

#include <sys/signalfd.h>
#include <unistd.h>

#include <algorithm>

#include "spikeloop/status/signals.hpp"

namespace spikeloop::status {

SignalWatch::SignalWatch(std::initializer_list<int> more) {
  sigset_t watched;
  sigemptyset(&watched);
  for (const int number : {SIGINT, SIGTERM, SIGQUIT, SIGUSR1}) {
    sigaddset(&watched, number);
  }
  const auto add = [&watched](int number) {
    if (!is_ignored(number)) {
      sigaddset(&watched, number);
    }
  };
  add(SIGHUP);
  std::ranges::for_each(more, add);
  pthread_sigmask(SIG_BLOCK, &watched, &before_);
  fd_ = Descriptor{signalfd(-1, &watched, SFD_CLOEXEC | SFD_NONBLOCK)};
}

SignalWatch::~SignalWatch() {
  // A late one must not kill us: the run has its outcome.
  while (next()) {
  }
  pthread_sigmask(SIG_SETMASK, &before_, nullptr);
}

std::optional<int> SignalWatch::next() const {
  signalfd_siginfo info{};
  return read(fd_.get(), &info, sizeof info) == sizeof info
             ? std::optional(static_cast<int>(info.ssi_signo))
             : std::nullopt;
}

}  // namespace spikeloop::status
