// How soon a robot must stand, on a machine that does other things too.
#pragma once

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <mutex>
#include <thread>
#include <vector>

namespace spikeloop::test {

/// The guard has 200 ms, the watchdog of a command adapter 100 ms. Between a fault and the robot's
/// callback several threads wake up, one after another. A thread that only sleeps measures how late
/// such threads are: its longest delay counts twice. On a quiet machine it is below a millisecond.
class Deadline {
 public:
  Deadline() : thread_([this] { measure(); }) {}
  ~Deadline() {
    ending_ = true;
    thread_.join();
  }
  Deadline(const Deadline&) = delete;
  Deadline& operator=(const Deadline&) = delete;

  /// In ms, of a robot that stands by now.
  /// @param begin of the fault; monotonic clock, ns
  double since(std::int64_t begin) const {
    const std::lock_guard lock(mutex_);
    double longest = 0;
    for (const Delay& delay : delays_) {
      longest = std::max(longest, delay.end > begin ? delay.ms : 0.0);
    }
    std::printf("threads of this machine woke up by up to %.1f ms too late\n", longest);
    return kMostMs + kThreads * longest;
  }

 private:
  struct Delay {
    std::int64_t end;  ///< monotonic clock, ns
    double ms;
  };
  static constexpr double kMostMs = 300;
  static constexpr double kThreads = 2;
  static constexpr std::chrono::milliseconds kSleep{2};

  void measure() {
    using std::chrono::steady_clock;
    while (!ending_) {
      const auto due = steady_clock::now() + kSleep;
      std::this_thread::sleep_until(due);
      const auto now = steady_clock::now();
      const double ms = std::chrono::duration<double, std::milli>(now - due).count();
      if (ms > 1) {
        const std::lock_guard lock(mutex_);
        delays_.push_back({std::chrono::nanoseconds(now.time_since_epoch()).count(), ms});
      }
    }
  }

  std::atomic<bool> ending_{false};
  mutable std::mutex mutex_;
  std::vector<Delay> delays_;
  std::thread thread_;  // last: it uses the others
};

}  // namespace spikeloop::test
