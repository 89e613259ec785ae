#include "spikeloop/command/watch.hpp"

#include <gtest/gtest.h>
#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <ctime>
#include <thread>
#include <utility>

#include "spikeloop/core/error.hpp"
#include "spikeloop/core/pacer.hpp"
#include "tests/support/error_of.hpp"
#include "tests/support/no_descriptors.hpp"

namespace watch_test {
namespace {

using spikeloop::TimeNs;
using namespace spikeloop::command;
using namespace std::chrono_literals;

constexpr TimeNs kMs = 1'000'000;

/// Of this process.
double processor_seconds() {
  return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

class WatchTest : public testing::Test {
 protected:
  WatchTest() { Watch::block_signals(); }

  Watch::Actions actions() {
    return {[this](StopReason reason) {
              ++(reason == StopReason::silent ? silent_ : continued_);
              stop_time_ = spikeloop::wall_now();
            },
            [this](TimeNs now) {
              ++polls_;
              return now + poll_again_;
            },
            [this] { ++interrupted_; }};
  }
  static bool eventually(const std::function<bool()>& condition) {
    for (int i = 0; i < 2000; ++i) {
      if (condition()) {
        return true;
      }
      std::this_thread::sleep_for(5ms);
    }
    return false;
  }

  std::atomic<int> silent_{0};
  std::atomic<int> continued_{0};
  std::atomic<int> interrupted_{0};
  std::atomic<int> polls_{0};
  std::atomic<TimeNs> stop_time_{0};
  TimeNs poll_again_ = kMs;
};

TEST_F(WatchTest, silence_stops_once_and_a_tick_arms_again) {
  Watch watch(50 * kMs, actions());
  std::this_thread::sleep_for(120ms);
  EXPECT_EQ(silent_, 0) << "before the first tick nothing is watched";
  const TimeNs beat = spikeloop::wall_now();
  watch.heartbeat();
  EXPECT_TRUE(eventually([&] { return silent_ == 1; }));
  EXPECT_GE(stop_time_ - beat, 50 * kMs);
  EXPECT_LE(stop_time_ - beat, 2000 * kMs);
  std::this_thread::sleep_for(120ms);
  EXPECT_EQ(silent_, 1);
  watch.heartbeat();
  EXPECT_TRUE(eventually([&] { return silent_ == 2; }));
}

TEST_F(WatchTest, rest_ends_the_watch) {
  Watch watch(300 * kMs, actions());
  watch.heartbeat();
  watch.rest();
  std::this_thread::sleep_for(450ms);
  EXPECT_EQ(silent_, 0);
}

TEST_F(WatchTest, sends_what_is_due_between_ticks_until_silence) {
  Watch watch(1000 * kMs, actions());
  watch.heartbeat(spikeloop::wall_now() + kMs);
  EXPECT_TRUE(eventually([&] { return silent_ == 1; }));
  const int polls = polls_;
  EXPECT_GE(polls, 5);
  EXPECT_LE(polls, 1100);
  const double before = processor_seconds();
  std::this_thread::sleep_for(400ms);
  EXPECT_EQ(polls_, polls);
  EXPECT_LT(processor_seconds() - before, 0.1) << "a watch of a loop that is silent sleeps";
}

TEST_F(WatchTest, an_earlier_time_wakes_it) {
  poll_again_ = 3600 * spikeloop::kNsPerSecond;
  Watch watch(3600 * spikeloop::kNsPerSecond, actions());
  watch.heartbeat(spikeloop::wall_now() + 3000 * spikeloop::kNsPerSecond);
  std::this_thread::sleep_for(20ms);
  EXPECT_EQ(polls_, 0);
  watch.heartbeat(spikeloop::wall_now() + kMs);
  EXPECT_TRUE(eventually([&] { return polls_ == 1; }));
}

TEST_F(WatchTest, signals) {
  Watch watch(3600 * spikeloop::kNsPerSecond, actions());
  kill(getpid(), SIGCONT);
  EXPECT_TRUE(eventually([&] { return continued_ == 1; }));
  kill(getpid(), SIGINT);
  EXPECT_TRUE(eventually([&] { return interrupted_ == 1; }));
  EXPECT_EQ(silent_, 0);
}

TEST_F(WatchTest, ticks_from_a_fast_loop_never_count_as_silence) {
  constexpr TimeNs kWatchdog = 100 * kMs;
  Watch watch(kWatchdog, actions());
  const TimeNs begin = spikeloop::wall_now();
  TimeNs longest = 0;  // a busy machine may keep this loop from its ticks: then silence is right
  TimeNs last = begin;
  int silent = 0;
  for (int i = 0; last - begin < 5 * kWatchdog; ++i) {
    watch.heartbeat(spikeloop::wall_now() + (i % 7) * 100'000);
    silent = silent_;
    const TimeNs now = spikeloop::wall_now();
    longest = std::max(longest, now - std::exchange(last, now));
  }
  if (longest < kWatchdog / 2) {
    EXPECT_EQ(silent, 0);
  }
  EXPECT_TRUE(eventually([&] { return silent_ >= 1; })) << "the loop has ended";
}

TEST_F(WatchTest, beats_before_during_and_after_silence) {
  std::atomic<int> beats{0};
  Watch::Actions with_beat = actions();
  with_beat.beat = [&](TimeNs now) {
    ++beats;
    return now + 5 * kMs;
  };
  Watch watch(20 * kMs, with_beat);
  EXPECT_TRUE(eventually([&] { return beats >= 3; })) << "no tick yet";
  watch.heartbeat();
  EXPECT_TRUE(eventually([&] { return silent_ == 1; }));
  const int before = beats;
  EXPECT_TRUE(eventually([&] { return beats >= before + 3; }));
  watch.rest();
  const int later = beats;
  EXPECT_TRUE(eventually([&] { return beats >= later + 3; }));
}

TEST_F(WatchTest, says_when_the_system_has_no_descriptors_left) {
  const std::string message = spikeloop::test::error_of<spikeloop::TransportError>([this] {
    const spikeloop::test::NoDescriptors none;
    Watch watch(kMs, actions());
  });
  EXPECT_EQ(message,
            "cannot watch the robot's commands: signalfd failed: Too many open files; raise the "
            "limit of open files (ulimit -n) [SL0109]");
}

}  // namespace
}  // namespace watch_test
