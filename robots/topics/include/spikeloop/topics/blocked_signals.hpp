// Threads that take no signals.
#pragma once

#include <signal.h>

namespace spikeloop::topics {

/// Threads begin with the signals blocked that are blocked where they are made. None of a
/// session's may take one that a program waits for.
class BlockedSignals {
 public:
  BlockedSignals() {
    sigset_t all;
    ::sigfillset(&all);
    ::pthread_sigmask(SIG_BLOCK, &all, &before_);
  }
  ~BlockedSignals() { ::pthread_sigmask(SIG_SETMASK, &before_, nullptr); }
  BlockedSignals(const BlockedSignals&) = delete;
  BlockedSignals& operator=(const BlockedSignals&) = delete;

 private:
  sigset_t before_{};
};

}  // namespace spikeloop::topics
