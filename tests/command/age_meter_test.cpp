#include "spikeloop/command/age_meter.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace {

using spikeloop::TimeNs;
using spikeloop::command::AgeMeter;

constexpr TimeNs kMs = 1'000'000;
const double kNan = std::nan("");

TEST(AgeMeter, nothing_is_known_before_the_first_message) {
  AgeMeter meter;
  EXPECT_EQ(meter.update(kNan, 5 * kMs), std::nullopt);
  EXPECT_EQ(meter.report().messages, 0u);
  EXPECT_TRUE(std::isnan(meter.report().latency_median_ms));
}

TEST(AgeMeter, latency_is_the_age_at_a_message_s_first_tick) {
  AgeMeter meter;
  EXPECT_EQ(meter.update(1.000, 1002 * kMs), 2 * kMs);
  EXPECT_EQ(meter.update(1.000, 1010 * kMs), 10 * kMs);
  EXPECT_EQ(meter.update(1.020, 1023 * kMs), 3 * kMs);
  EXPECT_EQ(meter.update(1.040, 1041 * kMs), 1 * kMs);
  const auto report = meter.report();
  EXPECT_EQ(report.messages, 3u);
  EXPECT_EQ(meter.messages(), 3u);
  EXPECT_DOUBLE_EQ(report.latency_median_ms, 2);
  EXPECT_DOUBLE_EQ(report.latency_p99_ms, 3);
  EXPECT_DOUBLE_EQ(report.age_max_ms, 10);
}

TEST(AgeMeter, percentiles_by_nearest_rank) {
  AgeMeter meter;
  for (int i = 1; i <= 200; ++i) {
    meter.update(i, i * spikeloop::kNsPerSecond + i * kMs);
  }
  EXPECT_DOUBLE_EQ(meter.report().latency_median_ms, 100);
  EXPECT_DOUBLE_EQ(meter.report().latency_p99_ms, 198);
  EXPECT_DOUBLE_EQ(meter.report().age_max_ms, 200);
}

TEST(AgeMeter, percentiles_are_those_of_the_newest_messages) {
  AgeMeter meter;
  constexpr int kMany = AgeMeter::kKept;
  for (int i = 1; i <= kMany + kMany / 2 + 1; ++i) {
    const TimeNs age = i <= kMany ? 1 : 9;
    meter.update(i, i * spikeloop::kNsPerSecond + age * kMs);
  }
  EXPECT_EQ(meter.report().messages, kMany + kMany / 2 + 1U);
  EXPECT_DOUBLE_EQ(meter.report().latency_median_ms, 9);
  EXPECT_DOUBLE_EQ(meter.report().latency_p99_ms, 9);
}

}  // namespace
