// Time limits for the end of a process. Leaving ROS waits for a master or a network, and may hang
// as long as it does not answer.
#pragma once

#include <atomic>
#include <chrono>
#include <memory>

namespace spikeloop::status {

/// Longest time from the end of a process's work to its end.
inline constexpr std::chrono::milliseconds kLongestEnd{1000};

/// Ends the process by _exit() unless it is destroyed in time.
class Deadline {
 public:
  Deadline(std::chrono::milliseconds limit, int exit_code);
  ~Deadline();
  Deadline(const Deadline&) = delete;
  Deadline& operator=(const Deadline&) = delete;

 private:
  std::shared_ptr<std::atomic<bool>> met_ = std::make_shared<std::atomic<bool>>(false);
};

/// To be called when the process has done its work and reported it: the process ends within
/// kLongestEnd, even if a destructor hangs. Flushes the standard streams. Returns `exit_code`.
int end_in_time(int exit_code);

}  // namespace spikeloop::status
