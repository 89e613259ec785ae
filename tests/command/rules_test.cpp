// The rules of sensors, spikes and the emergency stop, each against times that are worked out.
#include <gtest/gtest.h>

#include "spikeloop/command/operator_input.hpp"
#include "spikeloop/command/silence_watch.hpp"

namespace spikeloop::command::rules_test {
namespace {

constexpr TimeNs kMs = 1'000'000;

TEST(SilenceWatch, a_source_is_silent_when_its_timeout_is_over) {
  SilenceWatch watch({100 * kMs, 300 * kMs});
  watch.set_arrival(0, 1000 * kMs);
  watch.set_arrival(1, 1000 * kMs);
  EXPECT_EQ(watch.silent(1100 * kMs), std::nullopt) << "the timeout itself is not too long";
  EXPECT_EQ(watch.silent(1100 * kMs + 1), 0U);
  watch.set_arrival(0, 1200 * kMs);
  EXPECT_EQ(watch.silent(1300 * kMs), std::nullopt);
  watch.set_arrival(0, 1300 * kMs);
  EXPECT_EQ(watch.silent(1300 * kMs + 1), 1U);
}

TEST(SilenceWatch, a_source_that_was_never_heard_is_silent) {
  SilenceWatch watch({kMs, kMs});
  EXPECT_EQ(watch.silent(0), 0U);
  watch.set_arrival(0, 0);
  EXPECT_EQ(watch.silent(0), 1U);
}

TEST(SilenceWatch, without_a_timeout_a_source_may_be_silent) {
  EXPECT_EQ(SilenceWatch({0, 0}).silent(1'000'000 * kMs), std::nullopt);
  EXPECT_EQ(SilenceWatch({}).silent(0), std::nullopt);
}

TEST(EmergencyRule, true_stops_and_false_releases) {
  EmergencyRule rule({.topic = "/stop"});
  EXPECT_EQ(rule.verdict(false, 0), std::nullopt) << "nobody has to be there";
  rule.take(true, 5);
  EXPECT_EQ(rule.verdict(true, 5), StopReason::emergency);
  EXPECT_EQ(rule.verdict(false, 1'000'000 * kMs), StopReason::emergency)
      << "who pressed it and went has not released it";
  rule.take(false, 7);
  EXPECT_EQ(rule.verdict(true, 7), std::nullopt);
}

TEST(EmergencyRule, latched_nothing_releases) {
  EmergencyRule rule({.topic = "/stop", .latched = true});
  rule.take(false, 0);
  EXPECT_EQ(rule.verdict(true, 0), std::nullopt);
  rule.take(true, 1);
  rule.take(false, 2);
  EXPECT_EQ(rule.verdict(true, 2), StopReason::emergency);
}

TEST(EmergencyRule, required_a_publisher_has_to_be_there) {
  EmergencyRule rule({.topic = "/stop", .required = true});
  EXPECT_EQ(rule.verdict(false, 0), StopReason::emergency_unknown);
  EXPECT_EQ(rule.verdict(true, 0), std::nullopt);
  rule.take(true, 1);
  EXPECT_EQ(rule.verdict(false, 1), StopReason::emergency) << "what is known is said";
}

TEST(EmergencyRule, with_a_timeout_messages_have_to_come) {
  EmergencyRule rule({.topic = "/stop", .timeout = 200 * kMs});
  EXPECT_EQ(rule.verdict(true, 0), StopReason::emergency_unknown);
  rule.take(false, 1000 * kMs);
  EXPECT_EQ(rule.verdict(false, 1200 * kMs), std::nullopt);
  EXPECT_EQ(rule.verdict(true, 1200 * kMs + 1), StopReason::emergency_unknown);
  rule.take(false, 1300 * kMs);
  EXPECT_EQ(rule.verdict(true, 1300 * kMs), std::nullopt);
}

}  // namespace
}  // namespace spikeloop::command::rules_test
