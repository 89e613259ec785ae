// The signals that stop a run, as something to poll.
#pragma once

#include <signal.h>

#include <optional>

#include "spikeloop/status/status.hpp"

namespace spikeloop::launch {

/// Holds SIGINT, SIGTERM, SIGQUIT, SIGUSR1 and, unless nohup has it ignored, SIGHUP back from the
/// process for as long as it lives.
class SignalWatch {
 public:
  SignalWatch();
  ~SignalWatch();
  SignalWatch(const SignalWatch&) = delete;
  SignalWatch& operator=(const SignalWatch&) = delete;

  int fd() const { return fd_.get(); }
  /// The next signal that came, if any.
  std::optional<int> next() const;

 private:
  sigset_t before_{};
  status::Descriptor fd_;
};

}  // namespace spikeloop::launch
