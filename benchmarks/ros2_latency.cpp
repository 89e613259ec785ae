// How long a message takes to another process and back over ROS 2, on this machine:
//
//     ros2_latency [BYTES [MESSAGES [PERIOD_US]]]
//
// BYTES of a message (870: a scan of 100 beams), PERIOD_US between messages (2000; 0: the next one
// as soon as the answer is there). Prints the round trip's median, 99th percentile and maximum,
// and how many were lost.
#include <fmt/format.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <csignal>
#include <cstdlib>
#include <mutex>
#include <thread>
#include <vector>

#include "spikeloop/ros2/session.hpp"

namespace {

using namespace spikeloop;
using Clock = std::chrono::steady_clock;

constexpr const char* kType = "sensor_msgs/LaserScan";

topics::SessionSettings settings(const char* name) {
  const auto domain = std::to_string(100 + ::getpgrp() % 100);
  return {.node_name = name, .place = {{"ROS_DOMAIN_ID", domain}, {"ROS_LOCALHOST_ONLY", "1"}}};
}

/// Sends everything back, until it is killed.
[[noreturn]] void echo() {
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  ros2::Session session(settings("echo"));
  const auto pong = session.publisher("/pong", kType);
  const auto ping =
      session.subscriber({.topic = "/ping", .message_type = kType, .take = [&](auto message) {
                            pong->publish(message);
                          }});
  for (;;) {
    ::pause();
  }
}

/// Counts what comes back.
class Answers {
 public:
  void add() {
    const std::lock_guard lock(mutex_);
    ++count_;
    changed_.notify_one();
  }
  /// @return false when there are not as many after a second: one was lost
  bool wait_for(int count) {
    std::unique_lock lock(mutex_);
    return changed_.wait_for(lock, std::chrono::seconds(1), [&] { return count_ >= count; });
  }
  int count() {
    const std::lock_guard lock(mutex_);
    return count_;
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  int count_ = 0;
};

/// In microseconds, sorted.
std::vector<double> measure(std::size_t bytes, int count, std::chrono::microseconds period) {
  ros2::Session session(settings("ping"));
  Answers answers;
  const auto ping = session.publisher("/ping", kType);
  const auto pong = session.subscriber(
      {.topic = "/pong", .message_type = kType, .take = [&](auto) { answers.add(); }});
  while (!session.publishers_are_connected("/pong") || !ping->has_subscribers()) {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  std::vector<std::byte> message(bytes);
  message[1] = std::byte{1};
  std::vector<double> round_trips;
  auto next = Clock::now();
  for (int i = 0; i < count; ++i) {
    std::this_thread::sleep_until(next);
    const int wanted = answers.count() + 1;
    const auto begin = Clock::now();
    ping->publish(message);
    if (answers.wait_for(wanted)) {
      const std::chrono::duration<double, std::micro> trip = Clock::now() - begin;
      round_trips.push_back(trip.count());
    }
    next = std::max(next + period, Clock::now());
  }
  std::sort(round_trips.begin(), round_trips.end());
  return round_trips;
}

}  // namespace

int main(int argc, char** argv) {
  const auto argument = [&](int place, long otherwise) {
    return argc > place ? std::strtol(argv[place], nullptr, 10) : otherwise;
  };
  const auto bytes = static_cast<std::size_t>(std::max(argument(1, 870), 4L));
  const int count = static_cast<int>(std::max(argument(2, 5000), 1L));
  const std::chrono::microseconds period(argument(3, 2000));
  ::setpgid(0, 0);
  const pid_t child = ::fork();
  if (child == 0) {
    echo();
  }
  const std::vector<double> trips = measure(bytes, count, period);
  ::kill(child, SIGKILL);
  ::waitpid(child, nullptr, 0);
  if (trips.empty()) {
    fmt::print(stderr, "ros2_latency: no message came back\n");
    return 1;
  }
  fmt::print(
      "{} bytes, {} messages, {} us apart: round trip {:.0f} us, p99 {:.0f}, most {:.0f}; {} "
      "lost\n",
      bytes, count, period.count(), trips[trips.size() / 2], trips[trips.size() * 99 / 100],
      trips.back(), count - static_cast<int>(trips.size()));
  return 0;
}
