// The thread of the launcher that shows command adapters that their job is supervised.
#pragma once

#include <sys/types.h>

#include <atomic>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "spikeloop/core/pacer.hpp"
#include "spikeloop/status/supervision.hpp"

namespace spikeloop::launch {

/// The launcher's loop may wait for a slow disk or a new guard, but no longer.
inline constexpr TimeNs kLongestHang = 10 * kNsPerSecond;

/// Beats every 20 ms while all processes that supervise the job run and the launcher's loop turns.
class SupervisionThread {
 public:
  /// @param path path of the new file for the adapters @throws FileError
  explicit SupervisionThread(const std::string& path);
  ~SupervisionThread();
  SupervisionThread(const SupervisionThread&) = delete;
  SupervisionThread& operator=(const SupervisionThread&) = delete;

  /// The launcher's loop has turned. Without a call for kLongestHang no more beats are sent.
  void turn() { turned_.store(wall_now()); }
  /// Processes without which nobody supervises the job: no beats while one of them is stopped by
  /// SIGSTOP or SIGTSTP.
  void require(std::vector<pid_t> processes);
  /// Continues the guard (SIGCONT) as soon as it is stopped. 0: no guard
  void set_guard(pid_t guard) { guard_.store(guard); }
  /// True: robots are stopped until this is called with false.
  void suspend(bool suspended) { page_.suspend(suspended); }

  /// First process of require() that is stopped. 0: all run.
  pid_t stopped_process() const { return stopped_.load(); }
  /// See status::Supervision::robots().
  int robots() const { return page_.robots(); }
  /// True if the guard was continued since the last call.
  bool has_continued_guard() { return continued_.exchange(false); }

 private:
  void run();
  pid_t find_stopped();
  void continue_guard();

  status::Supervision page_;
  std::mutex mutex_;
  std::vector<pid_t> required_;
  std::atomic<TimeNs> turned_;
  std::atomic<pid_t> guard_{0};
  std::atomic<pid_t> stopped_{0};
  std::atomic<bool> continued_{false};
  std::atomic<bool> ending_{false};
  std::thread thread_;
};

}  // namespace spikeloop::launch
