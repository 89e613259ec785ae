// A domain of ROS 2 that no other test of this machine uses.
#pragma once

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <functional>
#include <stdexcept>
#include <string>
#include <thread>

#include "spikeloop/topics/session.hpp"

namespace spikeloop::test {

/// Taken by a lock that ends with the process.
class FreeDomain {
 public:
  FreeDomain() {
    for (number_ = 1; number_ <= 100; ++number_) {
      const auto path = std::filesystem::temp_directory_path() /
                        fmt::format("spikeloop-test-ros-domain-{}", number_);
      lock_ = ::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
      if (lock_ >= 0 && ::flock(lock_, LOCK_EX | LOCK_NB) == 0) {
        return;
      }
      ::close(lock_);
    }
    throw std::runtime_error("a hundred tests use a ROS domain each");
  }
  ~FreeDomain() { ::close(lock_); }
  FreeDomain(const FreeDomain&) = delete;
  FreeDomain& operator=(const FreeDomain&) = delete;

  int number() const { return number_; }
  std::string text() const { return std::to_string(number_); }
  /// On this machine alone.
  topics::Place place() const { return {{"ROS_DOMAIN_ID", text()}, {"ROS_LOCALHOST_ONLY", "1"}}; }

 private:
  int number_ = 0;
  int lock_ = -1;
};

/// Looks every millisecond. @return whether it has become true within the time
inline bool eventually(double seconds, const std::function<bool()>& condition) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
  while (!condition()) {
    if (std::chrono::steady_clock::now() > end) {
      return false;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return true;
}

}  // namespace spikeloop::test
