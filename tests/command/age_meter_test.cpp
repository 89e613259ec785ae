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

TEST(AgeMeter, latency_counts_to_the_sending_of_the_command) {
  AgeMeter meter;
  EXPECT_EQ(meter.update(1.000, 1002 * kMs), 2 * kMs);
  meter.settle(1003 * kMs);  // sent within the tick
  EXPECT_EQ(meter.update(1.000, 1010 * kMs), 10 * kMs);
  meter.settle(1011 * kMs);  // a repetition measures nothing
  EXPECT_EQ(meter.update(1.020, 1021 * kMs), 1 * kMs);
  EXPECT_EQ(meter.update(1.022, 1023 * kMs), 1 * kMs);
  EXPECT_EQ(meter.report().messages, 1u) << "the command of two messages is held back";
  meter.settle(1030 * kMs);
  const auto report = meter.report();
  EXPECT_EQ(report.messages, 3u);
  EXPECT_DOUBLE_EQ(report.latency_median_ms, 8);
  EXPECT_DOUBLE_EQ(report.latency_p99_ms, 10);
  EXPECT_DOUBLE_EQ(report.age_max_ms, 10);
}

TEST(AgeMeter, a_command_within_the_deadband_counts_to_its_tick) {
  AgeMeter meter;
  meter.update(1.000, 1004 * kMs);
  meter.settle(900 * kMs);  // sent before, and not changed since
  EXPECT_DOUBLE_EQ(meter.report().latency_median_ms, 4);
}

TEST(AgeMeter, messages_without_a_command_are_not_measured) {
  AgeMeter meter;
  meter.update(1.000, 1004 * kMs);
  meter.drop();
  meter.settle(1100 * kMs);
  EXPECT_EQ(meter.report().messages, 0u);
}

void measure(AgeMeter& meter, int second, TimeNs age) {
  const TimeNs sent = second * spikeloop::kNsPerSecond + age;
  meter.update(second, sent);
  meter.settle(sent);
}

TEST(AgeMeter, percentiles_by_nearest_rank) {
  AgeMeter meter;
  for (int i = 1; i <= 200; ++i) {
    measure(meter, i, i * kMs);
  }
  EXPECT_DOUBLE_EQ(meter.report().latency_median_ms, 100);
  EXPECT_DOUBLE_EQ(meter.report().latency_p99_ms, 198);
  EXPECT_DOUBLE_EQ(meter.report().age_max_ms, 200);
}

TEST(AgeMeter, percentiles_are_those_of_the_newest_messages) {
  AgeMeter meter;
  constexpr int kMany = AgeMeter::kKept;
  for (int i = 1; i <= kMany + kMany / 2 + 1; ++i) {
    measure(meter, i, i <= kMany ? kMs : 9 * kMs);
  }
  EXPECT_EQ(meter.report().messages, kMany + kMany / 2 + 1U);
  EXPECT_DOUBLE_EQ(meter.report().latency_median_ms, 9);
  EXPECT_DOUBLE_EQ(meter.report().latency_p99_ms, 9);
}

}  // namespace
