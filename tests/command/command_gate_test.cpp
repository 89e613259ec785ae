#include "spikeloop/command/command_gate.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace command_gate_test {
namespace {

using spikeloop::kNever;
using spikeloop::TimeNs;
using namespace spikeloop::command;

constexpr TimeNs kMs = 1'000'000;

CommandGate gate(double deadband, TimeNs min_interval, TimeNs period, TimeNs poll_grace = 0) {
  return CommandGate({.deadband = {deadband, deadband},
                      .min_interval = min_interval,
                      .period = period,
                      .poll_grace = poll_grace});
}

bool offer(CommandGate& gate, double a, double b, TimeNs now) {
  const double values[] = {a, b};
  return gate.offer(values, now);
}

TEST(CommandGate, first_command_leaves_at_once) {
  CommandGate g = gate(0.02, kMs, 100 * kMs);
  EXPECT_EQ(g.next_due(), kNever);
  EXPECT_FALSE(g.poll(5));
  EXPECT_TRUE(offer(g, 0, 0, -3 * kMs));
}

TEST(CommandGate, moves_beyond_the_deadband_leave_at_once) {
  CommandGate g = gate(0.02, kMs, 0);
  EXPECT_TRUE(offer(g, 0.5, 0.5, 0));
  EXPECT_FALSE(offer(g, 0.515, 0.49, 2 * kMs));
  EXPECT_TRUE(offer(g, 0.515, 0.53, 3 * kMs));
  EXPECT_DOUBLE_EQ(g.current()[1], 0.53);
}

TEST(CommandGate, slow_drift_adds_up_from_the_last_sent_one) {
  CommandGate g = gate(1.0 / 64, kMs, 0);
  int sent = 0;
  for (int i = 0; i <= 1000; ++i) {  // 1/1024 a tick: every 17 ticks the deadband is passed
    sent += offer(g, 1 + i / 1024.0, 1, i * kMs) ? 1 : 0;
  }
  EXPECT_EQ(sent, 1 + 1000 / 17);
}

TEST(CommandGate, coming_to_zero_is_never_too_small_a_move) {
  CommandGate g = gate(0.02, kMs, 0);
  EXPECT_TRUE(offer(g, 0.01, 0, 0));
  EXPECT_TRUE(offer(g, 0, 0, kMs));
  EXPECT_FALSE(offer(g, 0.01, 0, 2 * kMs));
}

TEST(CommandGate, held_back_for_the_least_interval) {
  CommandGate g = gate(0.02, 10 * kMs, 0);
  EXPECT_TRUE(offer(g, 0, 0, 0));
  EXPECT_FALSE(offer(g, 1, 0, 4 * kMs));
  EXPECT_EQ(g.next_due(), 10 * kMs);
  EXPECT_FALSE(g.poll(9 * kMs));
  EXPECT_TRUE(g.poll(10 * kMs));
  EXPECT_EQ(g.next_due(), kNever);
  // A move that is taken back before it could leave is forgotten.
  EXPECT_FALSE(offer(g, 0.5, 0, 15 * kMs));
  EXPECT_FALSE(offer(g, 1, 0, 16 * kMs));
  EXPECT_EQ(g.next_due(), kNever);
}

TEST(CommandGate, a_late_tick_does_not_hold_back_the_ones_that_follow) {
  CommandGate g({.deadband = {0, 0}, .min_interval = 10 * kMs, .tolerance = 5 * kMs});
  EXPECT_TRUE(offer(g, 1, 0, 0));
  EXPECT_TRUE(offer(g, 2, 0, 14 * kMs));   // 4 ms late
  EXPECT_TRUE(offer(g, 3, 0, 20 * kMs));   // on time
  EXPECT_FALSE(offer(g, 4, 0, 21 * kMs));  // a burst
  EXPECT_FALSE(offer(g, 5, 0, 22 * kMs));
  EXPECT_EQ(g.next_due(), 25 * kMs);
  EXPECT_TRUE(g.poll(25 * kMs));
  EXPECT_EQ(g.current()[0], 5);
  EXPECT_TRUE(offer(g, 6, 0, 30 * kMs));
  EXPECT_FALSE(offer(g, 6, 0, 40 * kMs));  // nothing new
}

TEST(CommandGate, repeats_at_the_command_rate) {
  CommandGate g = gate(0.02, kMs, 100 * kMs);
  int sent = 0;
  for (TimeNs t = 0; t < 1000 * kMs; t += kMs) {
    sent += offer(g, 0.3, 0, t) ? 1 : 0;
  }
  EXPECT_EQ(sent, 10);
}

TEST(CommandGate, poll_leaves_repetitions_to_the_next_tick) {
  CommandGate g = gate(0.02, kMs, 100 * kMs, 2 * kMs);
  EXPECT_TRUE(offer(g, 0.3, 0, 0));
  EXPECT_EQ(g.next_due(), 102 * kMs);
  EXPECT_FALSE(g.poll(101 * kMs));
  EXPECT_TRUE(offer(g, 0.3, 0, 100 * kMs));
  EXPECT_TRUE(g.poll(202 * kMs));
}

TEST(CommandGate, a_repetition_never_delays_a_change) {
  CommandGate g = gate(0.02, 10 * kMs, 50 * kMs);
  EXPECT_TRUE(offer(g, 0.3, 0, 0));
  EXPECT_TRUE(offer(g, 0.3, 0, 50 * kMs));  // a repetition
  EXPECT_TRUE(offer(g, 0.4, 0, 51 * kMs));
  EXPECT_FALSE(g.holds_back());
  EXPECT_FALSE(offer(g, 0.5, 0, 60 * kMs));  // a change so soon after the last one waits
  EXPECT_TRUE(g.holds_back());
  EXPECT_EQ(g.next_due(), 61 * kMs);
  EXPECT_TRUE(g.poll(61 * kMs));
  EXPECT_FALSE(g.holds_back());
}

TEST(CommandGate, the_first_repetition_waits_for_a_late_sensor) {
  CommandGate g(
      {.deadband = {0, 0}, .min_interval = 10 * kMs, .period = 50 * kMs, .grace = 12 * kMs});
  EXPECT_TRUE(offer(g, 1, 0, 0));
  EXPECT_FALSE(offer(g, 1, 0, 50 * kMs));
  EXPECT_TRUE(offer(g, 2, 0, 58 * kMs));  // its message was 8 ms late
  EXPECT_TRUE(offer(g, 2, 0, 120 * kMs));
  EXPECT_TRUE(offer(g, 2, 0, 170 * kMs)) << "the following ones come at the command rate";
  EXPECT_EQ(g.sent(), 4u);
}

TEST(CommandGate, force_and_forget) {
  CommandGate g = gate(0.02, 10 * kMs, 100 * kMs);
  const double zero[] = {0, 0};
  EXPECT_TRUE(offer(g, 1, 1, 0));
  g.force(zero, kMs);
  EXPECT_FALSE(offer(g, 1, 1, 2 * kMs));
  g.forget();
  EXPECT_TRUE(offer(g, 1, 1, 3 * kMs));
}

TEST(CommandGate, a_forced_command_is_repeated_within_bounds) {
  const auto repeated_after = [](TimeNs min_interval, TimeNs period) {
    CommandGate g = gate(0.02, min_interval, period, 50 * kMs);
    const double zero[] = {0, 0};
    g.force(zero, kMs);
    EXPECT_FALSE(g.poll(g.next_due() - 1));
    const TimeNs due = g.next_due();
    EXPECT_TRUE(g.poll(due));
    return due - kMs;
  };
  EXPECT_EQ(repeated_after(kMs, 50 * kMs), 50 * kMs);
  EXPECT_EQ(repeated_after(kMs, 0), kLongestRepetition);
  EXPECT_EQ(repeated_after(kMs, 1000 * kMs), kLongestRepetition);
  EXPECT_EQ(repeated_after(0, 1), kShortestRepetition);
  EXPECT_EQ(repeated_after(300 * kMs, 300 * kMs), 300 * kMs);
}

// Random commands and times: changes are never closer than the least interval, and no gap is longer
// than the period and the time to the next call.
TEST(CommandGate, intervals_stay_within_their_bounds) {
  std::mt19937 engine(3);
  std::uniform_real_distribution<double> value(-1, 1);
  std::uniform_int_distribution<TimeNs> wait(1, 2 * kMs);
  CommandGate g = gate(0.02, 5 * kMs, 20 * kMs);
  TimeNs last = 0;
  TimeNs last_change = 0;
  double before = 0;
  TimeNs now = 0;
  offer(g, 0, 0, now);
  for (int i = 0; i < 20000; ++i) {
    now += wait(engine);
    const bool sent =
        engine() % 3 == 0 ? offer(g, i / 500 % 2 ? value(engine) : 0.5, 0.5, now) : g.poll(now);
    ASSERT_LE(now - last, 22 * kMs);
    if (!sent) {
      continue;
    }
    last = now;
    if (std::abs(g.current()[0] - before) > 0.02) {
      ASSERT_GE(now - last_change, 5 * kMs);
      last_change = now;
    }
    before = g.current()[0];
  }
}

}  // namespace
}  // namespace command_gate_test
