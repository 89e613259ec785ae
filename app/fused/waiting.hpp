// How the loop waits for somebody else: with a heartbeat, and back at once when it is to stop.
#pragma once

#include <condition_variable>
#include <functional>
#include <mutex>

#include "spikeloop/core/time.hpp"

namespace spikeloop {

/// What the process has around its loop.
struct LoopSurroundings {
  std::function<bool()> stop;                 ///< True if the loop must end
  std::function<void(bool waits)> enter;      ///< reports to the launcher what the loop does
  TimeNs patience = 60 * kNsPerSecond;        ///< wall time; 0: no limit
  TimeNs start_patience = 60 * kNsPerSecond;  ///< wall time until the first tick
};

class Waiting {
 public:
  explicit Waiting(LoopSurroundings surroundings) : surroundings_(std::move(surroundings)) {}

  /// Something may have come. From any thread.
  void notify();
  /// Waits until `done`, which is asked after every notify() and every 20 ms.
  /// @param meanwhile called every 20 ms with the wall time that has passed; what it throws ends
  /// the wait
  /// @return false when the loop is to end
  bool until(const std::function<bool()>& done,
             const std::function<void(TimeNs waited)>& meanwhile);
  TimeNs patience() const { return surroundings_.patience; }
  TimeNs start_patience() const { return surroundings_.start_patience; }

 private:
  LoopSurroundings surroundings_;
  std::mutex mutex_;
  std::condition_variable come_;
};

}  // namespace spikeloop
