// The signals that stop a program, as something to poll.
#pragma once

#include <signal.h>

#include <initializer_list>
#include <optional>

#include "spikeloop/processes/descriptor.hpp"

namespace spikeloop::status {

/// Holds SIGINT, SIGTERM, SIGQUIT, SIGUSR1 and, unless nohup has it ignored, SIGHUP back from the
/// process for as long as it lives.
class SignalWatch {
 public:
  /// @param more further signals to hold back, except those that are ignored
  explicit SignalWatch(std::initializer_list<int> more = {});
  ~SignalWatch();
  SignalWatch(const SignalWatch&) = delete;
  SignalWatch& operator=(const SignalWatch&) = delete;

  int fd() const { return fd_.get(); }
  /// The next signal that came, if any.
  std::optional<int> next() const;

 private:
  sigset_t before_{};
  Descriptor fd_;
};

}  // namespace spikeloop::status
