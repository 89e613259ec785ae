#include "spikeloop/guard/guard_timer.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace {

using namespace spikeloop::guard;
using spikeloop::kNever;
using spikeloop::kNsPerSecond;
using spikeloop::TimeNs;

constexpr TimeNs kMs = 1'000'000;
constexpr TimeNs kWatchdog = 100 * kMs;

/// Times in ms at which zeros leave until `end`, looked at every ms.
std::vector<TimeNs> zeros(GuardTimer& timer, TimeNs begin, TimeNs end, bool heard = true) {
  std::vector<TimeNs> times;
  for (TimeNs now = begin; now <= end; now += kMs) {
    const bool due = timer.next_due() <= now;
    if (timer.poll(now, heard)) {
      EXPECT_TRUE(due) << "next_due() is later than the zero";
      times.push_back(now / kMs);
    }
  }
  return times;
}

TEST(GuardTimer, does_nothing_while_beats_come) {
  GuardTimer timer(kWatchdog, 0);
  for (TimeNs now = 0; now < kNsPerSecond; now += kBeatPeriod) {
    timer.beat(now);
    EXPECT_FALSE(timer.poll(now, true));
    EXPECT_EQ(timer.next_due(), now + timer.deadline() + 1);
  }
  EXPECT_FALSE(timer.cause());
}

TEST(GuardTimer, silence_stops_the_robot_after_watchdog_and_margin) {
  GuardTimer timer(kWatchdog, 0);
  timer.beat(7 * kMs);
  EXPECT_LE(timer.deadline(), kWatchdog + 200 * kMs);
  const TimeNs first = (7 * kMs + timer.deadline()) / kMs + 1;
  EXPECT_EQ(zeros(timer, 0, 3000 * kMs),
            (std::vector<TimeNs>{first, first + 50, first + 100, first + 150, first + 200}));
  EXPECT_EQ(timer.cause(), Cause::silent);
  EXPECT_FALSE(timer.over());
  EXPECT_FALSE(timer.stopping());
  EXPECT_EQ(timer.next_due(), kNever);
}

TEST(GuardTimer, a_beat_ends_the_zeros_and_arms_again) {
  GuardTimer timer(kWatchdog, 0);
  EXPECT_EQ(zeros(timer, 0, 260 * kMs).size(), 2u);
  timer.beat(261 * kMs);
  EXPECT_FALSE(timer.cause());
  EXPECT_EQ(zeros(timer, 261 * kMs, 461 * kMs).size(), 0u);
  EXPECT_EQ(zeros(timer, 462 * kMs, 3000 * kMs).size(), 5u);
}

TEST(GuardTimer, a_lost_connection_stops_the_robot_at_once) {
  GuardTimer timer(kWatchdog, 0);
  timer.lost(30 * kMs);
  timer.beat(31 * kMs);
  timer.done();
  EXPECT_EQ(zeros(timer, 30 * kMs, 3000 * kMs), (std::vector<TimeNs>{30, 80, 130, 180, 230}));
  EXPECT_EQ(timer.cause(), Cause::lost);
  EXPECT_TRUE(timer.over());
}

TEST(GuardTimer, a_silent_one_that_is_lost_is_stopped_again) {
  GuardTimer timer(kWatchdog, 0);
  EXPECT_EQ(zeros(timer, 0, 1000 * kMs).size(), 5u);
  timer.lost(1001 * kMs);
  EXPECT_EQ(zeros(timer, 1001 * kMs, 3000 * kMs).size(), 5u);
  EXPECT_TRUE(timer.over());
}

TEST(GuardTimer, nothing_follows_a_good_end) {
  GuardTimer timer(kWatchdog, 0);
  timer.done();
  timer.lost(kMs);
  EXPECT_EQ(zeros(timer, 0, 3000 * kMs).size(), 0u);
  EXPECT_TRUE(timer.over());
  EXPECT_FALSE(timer.cause());
}

TEST(GuardTimer, zeros_without_a_subscriber_do_not_count_for_three_seconds) {
  GuardTimer timer(kWatchdog, 0);
  timer.lost(0);
  EXPECT_EQ(zeros(timer, 0, 400 * kMs, false).size(), 9u);
  EXPECT_FALSE(timer.robot_stopped());
  EXPECT_EQ(zeros(timer, 401 * kMs, 3000 * kMs).size(), 5u);
  EXPECT_TRUE(timer.robot_stopped());
  GuardTimer alone(kWatchdog, 0);
  alone.lost(0);
  EXPECT_EQ(zeros(alone, 0, 5000 * kMs, false).back(), 3000);
  EXPECT_TRUE(alone.over());
  EXPECT_FALSE(alone.robot_stopped());
}

TEST(GuardTimer, a_beat_forgets_that_the_robot_was_stopped) {
  GuardTimer timer(kWatchdog, 0);
  zeros(timer, 0, 1000 * kMs);
  EXPECT_TRUE(timer.robot_stopped());
  timer.beat(1001 * kMs);
  timer.lost(1002 * kMs);
  zeros(timer, 1002 * kMs, 5000 * kMs, false);
  EXPECT_FALSE(timer.robot_stopped());
}

TEST(GuardTimer, a_watchdog_of_years_never_runs_out) {
  GuardTimer timer(kNever - 1, 0);
  EXPECT_FALSE(timer.poll(1'000'000 * kNsPerSecond, true));
  EXPECT_GT(timer.next_due(), 1'000'000 * kNsPerSecond);
}

}  // namespace
