// Emergency stop and manual commands beside the network's: who wins, and what then leaves.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "counter.hpp"
#include "spikeloop/command/operator_input.hpp"

namespace spikeloop::command::intervention_test {
namespace {

using testing::AllOf;
using testing::Each;
using testing::ElementsAre;
using testing::Ge;
using testing::IsEmpty;
using testing::SizeIs;

constexpr TimeNs kMs = 1'000'000;

/// One component; repeated every 100 ms; manual commands hold for 500 ms.
class InterventionTest : public testing::Test {
 protected:
  explicit InterventionTest(std::vector<Bounds> bounds = {})
      : channel_({.gate = {{0.02}, kMs, 100 * kMs},
                  .bounds = std::move(bounds),
                  .manual = {.timeout = 500 * kMs}},
                 [this](auto values) { sent_.push_back(values[0]); }) {}

  void command(double value, TimeNs now) { channel_.command({&value, 1}, now); }
  void manual(double value, TimeNs now) { channel_.override_with({&value, 1}, now); }
  void press(TimeNs now) { channel_.hold(StopReason::emergency, now); }
  void release(TimeNs now) { channel_.hold(std::nullopt, now); }
  std::uint64_t count(const std::string& name) const { return counter(channel_, name); }

  std::vector<double> sent_;
  CommandChannel channel_;
};

TEST_F(InterventionTest, emergency_stop_is_a_zero_at_once_and_nothing_else_until_it_is_released) {
  command(0.5, 0);
  press(10 * kMs);
  EXPECT_THAT(sent_, ElementsAre(0.5, 0));
  EXPECT_EQ(channel_.standing().stopped, StopReason::emergency);
  for (TimeNs t = 11 * kMs; t < 310 * kMs; t += kMs) {
    command(0.5, t);
  }
  EXPECT_THAT(sent_, ElementsAre(0.5, 0, 0, 0)) << "repeated at 110 and 210 ms";
  channel_.poll(310 * kMs);
  EXPECT_EQ(sent_.size(), 5U) << "and when the loop hangs";
  release(320 * kMs);
  EXPECT_EQ(sent_.size(), 5U);
  command(0.5, 321 * kMs);
  EXPECT_EQ(sent_.back(), 0.5);
  EXPECT_EQ(count("stops_emergency_stop"), 1U);
  EXPECT_EQ(count("resumed"), 1U);
}

TEST_F(InterventionTest, emergency_stop_holds_before_the_first_command) {
  press(0);
  EXPECT_THAT(sent_, ElementsAre(0)) << "a request from outside always sends one";
  command(0.5, kMs);
  EXPECT_THAT(sent_, ElementsAre(0));
  release(2 * kMs);
  command(0.5, 3 * kMs);
  EXPECT_THAT(sent_, ElementsAre(0, 0.5));
}

TEST_F(InterventionTest, released_before_the_first_command_nothing_leaves) {
  press(0);
  release(kMs);
  EXPECT_EQ(channel_.poll(1000 * kMs), kNever);
  channel_.stop(StopReason::no_value, 1001 * kMs);
  EXPECT_THAT(sent_, ElementsAre(0));
}

TEST_F(InterventionTest, a_release_does_not_undo_other_stops) {
  command(0.5, 0);
  press(10 * kMs);
  channel_.stop(StopReason::silent, 20 * kMs);
  release(30 * kMs);
  EXPECT_EQ(channel_.standing().stopped, StopReason::silent);
  EXPECT_THAT(sent_, ElementsAre(0.5, 0, 0));
  EXPECT_EQ(channel_.poll(130 * kMs), 230 * kMs);
  EXPECT_THAT(sent_, ElementsAre(0.5, 0, 0, 0));
}

TEST_F(InterventionTest, nothing_leaves_after_the_end_whatever_people_say) {
  command(0.5, 0);
  channel_.stop(StopReason::ended, kMs);
  press(2 * kMs);
  release(3 * kMs);
  manual(0.3, 4 * kMs);
  EXPECT_THAT(sent_, ElementsAre(0.5, 0));
}

TEST_F(InterventionTest, manual_commands_leave_in_place_of_the_networks) {
  command(0.5, 0);
  manual(-0.2, 10 * kMs);
  for (TimeNs t = 11 * kMs; t < 100 * kMs; t += kMs) {
    command(0.5, t);
  }
  EXPECT_THAT(sent_, ElementsAre(0.5, -0.2));
  manual(0.1, 100 * kMs);
  EXPECT_EQ(sent_.back(), 0.1);
  command(0.5, 599 * kMs);
  EXPECT_EQ(sent_.back(), 0.1) << "500 ms from the newest one";
  EXPECT_TRUE(channel_.standing().overridden);
  command(0.5, 600 * kMs);
  EXPECT_EQ(sent_.back(), 0.5);
  EXPECT_FALSE(channel_.standing().overridden);
  EXPECT_EQ(count("overrides"), 1U);
}

TEST_F(InterventionTest, manual_commands_drive_a_robot_whose_network_may_not_and_end_with_a_zero) {
  for (const StopReason reason : {StopReason::no_value, StopReason::stale, StopReason::silent}) {
    const TimeNs begin = 10'000 * kMs * (1 + static_cast<int>(reason));
    command(0.5, begin);
    channel_.stop(reason, begin + kMs);
    manual(0.2, begin + 10 * kMs);
    channel_.stop(reason, begin + 11 * kMs);
    EXPECT_EQ(sent_.back(), 0.2) << stop_reason_name(reason);
    channel_.poll(begin + 509 * kMs);
    EXPECT_EQ(sent_.back(), 0.2) << stop_reason_name(reason);
    channel_.poll(begin + 510 * kMs);
    EXPECT_EQ(sent_.back(), 0) << stop_reason_name(reason);
    EXPECT_EQ(channel_.standing().stopped, reason);
  }
}

TEST_F(InterventionTest, manual_commands_before_any_of_the_network_end_with_a_zero) {
  manual(0.2, 0);
  EXPECT_EQ(channel_.poll(500 * kMs), 600 * kMs) << "zeros are repeated";
  EXPECT_THAT(sent_, ElementsAre(0.2, 0));
}

TEST_F(InterventionTest, emergency_stop_wins_over_manual_commands_and_ends_them) {
  command(0.5, 0);
  manual(0.2, 10 * kMs);
  press(20 * kMs);
  manual(0.3, 30 * kMs);
  EXPECT_THAT(sent_, ElementsAre(0.5, 0.2, 0));
  release(40 * kMs);
  command(0.5, 41 * kMs);
  EXPECT_EQ(sent_.back(), 0.5);
}

TEST_F(InterventionTest, manual_commands_wait_after_a_continue) {
  command(0.5, 0);
  channel_.stop(StopReason::continued, kMs);
  manual(0.2, 2 * kMs);
  EXPECT_EQ(sent_.back(), 0);
  manual(0.2, kMs + kContinuedPause);
  EXPECT_EQ(sent_.back(), 0.2);
}

TEST_F(InterventionTest, a_manual_command_that_is_not_finite_is_a_zero) {
  command(0.5, 0);
  manual(0.2, 10 * kMs);
  manual(std::nan(""), 20 * kMs);
  EXPECT_EQ(sent_.back(), 0);
  command(0.5, 30 * kMs);
  EXPECT_EQ(sent_.back(), 0);
  EXPECT_EQ(count("stops_not_finite"), 1U);
}

/// Never slower than 0.1.
class AheadTest : public InterventionTest {
 protected:
  AheadTest() : InterventionTest({{0.1, 0.8}}) {}

  /// What leaves in half a second when a person says this, and the network 0.5 all the time.
  std::vector<double> sent_after_manual(double value) {
    command(0.5, 0);
    EXPECT_THAT(sent_, ElementsAre(0.5));
    manual(value, 10 * kMs);
    for (TimeNs t = 11 * kMs; t < 500 * kMs; t += kMs) {
      command(0.5, t);
      channel_.poll(t);
    }
    return {sent_.begin() + 1, sent_.end()};
  }
};

TEST_F(AheadTest, a_manual_command_that_is_not_finite_is_a_zero_whatever_the_limits) {
  EXPECT_THAT(sent_after_manual(std::nan("")), AllOf(SizeIs(Ge(1)), Each(0)));
  EXPECT_EQ(channel_.standing().stopped, StopReason::not_finite);
  manual(0.3, 501 * kMs);
  EXPECT_EQ(sent_.back(), 0.3);
  command(0.5, 1100 * kMs);
  EXPECT_EQ(sent_.back(), 0.5) << "the hand's time is over";
}

TEST_F(AheadTest, a_manual_zero_has_the_robot_stand_whatever_the_limits) {
  EXPECT_THAT(sent_after_manual(0), AllOf(SizeIs(Ge(1)), Each(0)));
  EXPECT_EQ(count("limited"), 0U);
  manual(0.05, 501 * kMs);
  EXPECT_EQ(sent_.back(), 0.1);
  command(0, 1100 * kMs);
  EXPECT_EQ(sent_.back(), 0.1) << "of the network a zero is a speed as any";
}

/// At most 1 in either direction, 2 a second.
class BoundedTest : public InterventionTest {
 protected:
  BoundedTest() : InterventionTest({{-1, 1, 2}}) {}
};

TEST_F(BoundedTest, what_leaves_is_within_the_bounds_and_starts_at_zero) {
  command(7, 1000 * kMs);
  command(7, 1100 * kMs);
  command(7, 1500 * kMs);
  command(7, 2000 * kMs);
  EXPECT_THAT(sent_, ElementsAre(0, 0.2, 1, 1));
  EXPECT_EQ(count("limited"), 4U);
  ASSERT_TRUE(channel_.first_cut());
  EXPECT_EQ(channel_.first_cut()->value, 7);
}

TEST_F(BoundedTest, a_stop_is_never_slewed_and_afterwards_the_way_starts_at_zero) {
  command(1, 0);
  command(1, 500 * kMs);
  channel_.stop(StopReason::stale, 501 * kMs);
  EXPECT_THAT(sent_, ElementsAre(0, 1, 0));
  command(1, 5000 * kMs);
  command(1, 5100 * kMs);
  EXPECT_THAT(sent_, ElementsAre(0, 1, 0, 0, 0.2));
}

TEST_F(BoundedTest, for_a_robot_that_comes_late_the_way_starts_at_zero) {
  command(1, 0);
  command(1, 500 * kMs);
  channel_.restart_commands(5000 * kMs);
  command(1, 5000 * kMs);
  command(1, 5100 * kMs);
  EXPECT_THAT(sent_, ElementsAre(0, 1, 0, 0.2));
}

TEST_F(BoundedTest, manual_commands_have_the_bounds_too) {
  command(-1, 0);
  command(-1, 500 * kMs);
  manual(4, 600 * kMs);
  command(-1, 900 * kMs);
  command(-1, 1000 * kMs);
  EXPECT_THAT(sent_, ElementsAre(0, -1, -0.8, testing::DoubleNear(-0.2, 1e-12),
                                 testing::DoubleNear(0, 1e-12)));
  manual(4, 1000 * kMs);
  command(-1, 1499 * kMs);
  EXPECT_NEAR(sent_.back(), 0.998, 1e-12);
}

TEST_F(InterventionTest, what_is_said_counts_when_it_is_applied) {
  OperatorInput people({.topic = "/stop", .required = true}, channel_);
  command(0.5, 0);
  bool there = true;
  people.watch_publishers([&] { return there; });
  const double backwards[] = {-0.3};
  people.override_with(backwards);
  EXPECT_THAT(sent_, ElementsAre(0.5));
  people.apply(0, kMs);
  EXPECT_THAT(sent_, ElementsAre(0.5, -0.3));
  people.apply(0, 2 * kMs);
  EXPECT_THAT(sent_, ElementsAre(0.5, -0.3)) << "once";
  people.emergency(true, 0);
  people.apply(0, 3 * kMs);
  EXPECT_EQ(channel_.standing().stopped, StopReason::emergency);
  people.emergency(false, 0);
  people.apply(0, 4 * kMs);
  command(0.5, 5 * kMs);
  EXPECT_EQ(channel_.standing().stopped, std::nullopt);
  there = false;
  people.apply(0, 6 * kMs);
  EXPECT_EQ(channel_.standing().stopped, StopReason::emergency_unknown);
}

TEST_F(InterventionTest, no_message_releases_the_stop_button) {
  OperatorInput people({.topic = "/stop"}, channel_);
  command(0.5, 0);
  people.press_stop(true);
  people.emergency(false, 0);
  people.apply(0, kMs);
  EXPECT_EQ(channel_.standing().stopped, StopReason::stop_button);
  people.emergency(true, 0);
  people.press_stop(false);
  people.apply(0, 2 * kMs);
  EXPECT_EQ(channel_.standing().stopped, StopReason::emergency);
  people.emergency(false, 0);
  people.apply(0, 3 * kMs);
  command(0.5, 4 * kMs);
  EXPECT_EQ(channel_.standing().stopped, std::nullopt);
}

TEST_F(InterventionTest, only_zeros_are_sent_without_supervision) {
  OperatorInput input({.topic = "/stop"}, channel_);
  command(0.5, 0);
  input.set_lost_supervision(StopReason::unsupervised);
  input.apply(0, kMs);
  EXPECT_EQ(channel_.standing().stopped, StopReason::unsupervised);
  manual(0.7, 2 * kMs);
  command(0.5, 150 * kMs);
  channel_.poll(250 * kMs);
  EXPECT_THAT(sent_, ElementsAre(0.5, 0, 0, 0)) << "zeros are repeated";
  input.emergency(true, 0);
  input.apply(0, 251 * kMs);
  EXPECT_EQ(channel_.standing().stopped, StopReason::emergency);
  input.emergency(false, 0);
  input.set_lost_supervision(std::nullopt);
  input.apply(0, 252 * kMs);
  command(0.5, 253 * kMs);
  EXPECT_EQ(channel_.standing().stopped, std::nullopt);
  EXPECT_EQ(sent_.back(), 0.5);
  EXPECT_EQ(count("stops_unsupervised"), 1U);
}

}  // namespace
}  // namespace spikeloop::command::intervention_test
