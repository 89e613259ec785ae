// Tells the launcher all the time that this process lives, and what it does: so that a job that
// stands still can be explained.
#pragma once

#include <atomic>
#include <condition_variable>
#include <mutex>
#include <thread>

#include "spikeloop/status/status.hpp"

namespace spikeloop::status {

class Heartbeat {
 public:
  /// Begins in Phase::preparing; does nothing without a launcher. The sender must outlive it.
  explicit Heartbeat(const Sender& sender);
  ~Heartbeat();
  Heartbeat(const Heartbeat&) = delete;
  Heartbeat& operator=(const Heartbeat&) = delete;

  void enter(Phase phase) { phase_.store(phase, std::memory_order_relaxed); }
  void at(TimeNs simulated) { simulated_.store(simulated, std::memory_order_relaxed); }

 private:
  void run();

  const Sender& sender_;
  std::atomic<Phase> phase_{Phase::preparing};
  std::atomic<TimeNs> simulated_{0};
  std::mutex mutex_;
  std::condition_variable wake_;
  bool ended_ = false;
  std::thread thread_;
};

}  // namespace spikeloop::status
