#include "spikeloop/guard/vigil.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace {

using namespace spikeloop::guard;
using spikeloop::kNsPerSecond;
using spikeloop::TimeNs;

constexpr TimeNs kMs = 1'000'000;
constexpr TimeNs kWatchdog = 100 * kMs;

/// Times in ms at which zeros leave until `end`, looked at every ms.
std::vector<TimeNs> zeros(Vigil& vigil, TimeNs begin, TimeNs end, bool heard = true) {
  std::vector<TimeNs> times;
  for (TimeNs now = begin; now <= end; now += kMs) {
    const bool due = vigil.next_due() <= now;
    if (vigil.poll(now, heard)) {
      EXPECT_TRUE(due) << "next_due() is later than the zero";
      times.push_back(now / kMs);
    }
  }
  return times;
}

TEST(Vigil, does_nothing_while_beats_come) {
  Vigil vigil(kWatchdog, 0);
  for (TimeNs now = 0; now < kNsPerSecond; now += kBeatPeriod) {
    vigil.beat(now);
    EXPECT_FALSE(vigil.poll(now, true));
    EXPECT_EQ(vigil.next_due(), now + vigil.deadline() + 1);
  }
  EXPECT_FALSE(vigil.cause());
}

TEST(Vigil, silence_stops_the_robot_after_watchdog_and_margin) {
  Vigil vigil(kWatchdog, 0);
  vigil.beat(7 * kMs);
  EXPECT_LE(vigil.deadline(), kWatchdog + 200 * kMs);
  const TimeNs first = (7 * kMs + vigil.deadline()) / kMs + 1;
  EXPECT_EQ(zeros(vigil, 0, 3000 * kMs),
            (std::vector<TimeNs>{first, first + 50, first + 100, first + 150, first + 200}));
  EXPECT_EQ(vigil.cause(), Cause::silent);
  EXPECT_FALSE(vigil.over());
  EXPECT_FALSE(vigil.stopping());
  EXPECT_EQ(vigil.next_due(), kNever);
}

TEST(Vigil, a_beat_ends_the_zeros_and_arms_again) {
  Vigil vigil(kWatchdog, 0);
  EXPECT_EQ(zeros(vigil, 0, 260 * kMs).size(), 2u);
  vigil.beat(261 * kMs);
  EXPECT_FALSE(vigil.cause());
  EXPECT_EQ(zeros(vigil, 261 * kMs, 461 * kMs).size(), 0u);
  EXPECT_EQ(zeros(vigil, 462 * kMs, 3000 * kMs).size(), 5u);
}

TEST(Vigil, a_lost_connection_stops_the_robot_at_once) {
  Vigil vigil(kWatchdog, 0);
  vigil.lost(30 * kMs);
  vigil.beat(31 * kMs);
  vigil.done();
  EXPECT_EQ(zeros(vigil, 30 * kMs, 3000 * kMs), (std::vector<TimeNs>{30, 80, 130, 180, 230}));
  EXPECT_EQ(vigil.cause(), Cause::lost);
  EXPECT_TRUE(vigil.over());
}

TEST(Vigil, a_silent_one_that_is_lost_is_stopped_again) {
  Vigil vigil(kWatchdog, 0);
  EXPECT_EQ(zeros(vigil, 0, 1000 * kMs).size(), 5u);
  vigil.lost(1001 * kMs);
  EXPECT_EQ(zeros(vigil, 1001 * kMs, 3000 * kMs).size(), 5u);
  EXPECT_TRUE(vigil.over());
}

TEST(Vigil, nothing_follows_a_good_end) {
  Vigil vigil(kWatchdog, 0);
  vigil.done();
  vigil.lost(kMs);
  EXPECT_EQ(zeros(vigil, 0, 3000 * kMs).size(), 0u);
  EXPECT_TRUE(vigil.over());
  EXPECT_FALSE(vigil.cause());
}

TEST(Vigil, zeros_that_nobody_hears_do_not_count_for_a_second) {
  Vigil vigil(kWatchdog, 0);
  vigil.lost(0);
  EXPECT_EQ(zeros(vigil, 0, 400 * kMs, false).size(), 9u);
  EXPECT_EQ(zeros(vigil, 401 * kMs, 3000 * kMs).size(), 5u);
  Vigil alone(kWatchdog, 0);
  alone.lost(0);
  EXPECT_EQ(zeros(alone, 0, 3000 * kMs, false).back(), 1000);
  EXPECT_TRUE(alone.over());
}

TEST(Vigil, a_watchdog_of_years_never_runs_out) {
  Vigil vigil(kNever - 1, 0);
  EXPECT_FALSE(vigil.poll(1'000'000 * kNsPerSecond, true));
  EXPECT_GT(vigil.next_due(), 1'000'000 * kNsPerSecond);
}

}  // namespace
