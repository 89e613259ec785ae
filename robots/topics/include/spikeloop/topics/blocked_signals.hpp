// Starts threads with blocked signals.
#pragma once

#include <signal.h>

namespace spikeloop::topics {

/// New threads inherit the blocked signals of the thread that starts them. Threads of a session
/// must not take a signal for which the program waits.
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
