#include "spikeloop/command/command_channel.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "counter.hpp"

namespace command_channel_test {
namespace {

using spikeloop::kNever;
using spikeloop::TimeNs;
using namespace spikeloop::command;
using testing::ElementsAre;
using testing::IsEmpty;

constexpr TimeNs kMs = 1'000'000;
const double kNan = std::nan("");

class CommandChannelTest : public testing::Test {
 protected:
  void TearDown() override { EXPECT_EQ(count("sent"), sent_.size()); }
  void command(double a, double b, TimeNs now) {
    const double values[] = {a, b};
    next_ = channel_.command(values, now);
  }
  std::uint64_t count(const std::string& name) const { return counter(channel_, name); }

  std::vector<std::vector<double>> sent_;
  TimeNs next_ = 0;
  CommandChannel channel_{{.gate = {{0.02, 0.02}, kMs, 100 * kMs}}, [this](auto values) {
                            sent_.emplace_back(values.begin(), values.end());
                          }};
};

TEST_F(CommandChannelTest, nothing_leaves_before_the_first_value) {
  command(kNan, kNan, 0);
  channel_.stop(StopReason::stale, kMs);
  EXPECT_EQ(channel_.poll(200 * kMs), kNever);
  EXPECT_THAT(sent_, IsEmpty());
  command(0.5, 0, 201 * kMs);
  EXPECT_THAT(sent_, ElementsAre(ElementsAre(0.5, 0)));
  EXPECT_EQ(count("resumed"), 0u);
}

TEST_F(CommandChannelTest, a_robot_that_comes_late_gets_the_same_command) {
  channel_.restart_commands(0);
  command(0.5, 0, kMs);
  command(0.5, 0, 2 * kMs);
  EXPECT_EQ(sent_.size(), 1u);
  channel_.restart_commands(3 * kMs);
  command(0.5, 0, 4 * kMs);
  EXPECT_THAT(sent_, ElementsAre(ElementsAre(0.5, 0), ElementsAre(0.5, 0)));
  channel_.stop(StopReason::emergency, 5 * kMs);
  channel_.restart_commands(6 * kMs);
  EXPECT_EQ(sent_.size(), 3u) << "a stop stays one";
}

TEST_F(CommandChannelTest, not_finite_is_never_sent_and_stops) {
  command(0.5, 0.1, 0);
  command(0.5, kNan, kMs);
  command(0.5, kNan, 2 * kMs);
  command(std::numeric_limits<double>::infinity(), 0, 3 * kMs);
  EXPECT_THAT(sent_, ElementsAre(ElementsAre(0.5, 0.1), ElementsAre(0, 0)));
  EXPECT_EQ(count("stops_not_finite"), 1u);
  command(kNan, kNan, 4 * kMs);
  EXPECT_EQ(count("stops_without_value"), 1u);
  command(0.5, 0.1, 5 * kMs);
  EXPECT_THAT(sent_.back(), ElementsAre(0.5, 0.1));
  EXPECT_EQ(count("resumed"), 1u);
  EXPECT_EQ(count("commands"), 2u);
}

TEST_F(CommandChannelTest, zeros_of_stale_data_are_repeated) {
  command(0.5, 0.1, 0);
  for (TimeNs t = kMs; t <= 501 * kMs; t += kMs) {
    channel_.stop(StopReason::stale, t);
  }
  EXPECT_EQ(sent_.size(), 1u + 1 + 5);
  EXPECT_EQ(count("stops_data_too_old"), 1u);
  // The least interval does not hold the first command after a stop.
  command(0.5, 0.1, 501 * kMs + 1);
  EXPECT_THAT(sent_.back(), ElementsAre(0.5, 0.1));
}

TEST_F(CommandChannelTest, the_time_that_it_stands_is_summed_up_until_the_end) {
  channel_.stop(StopReason::stale, 0);
  command(0.5, 0, 10 * kMs);
  EXPECT_EQ(channel_.stopped_time(), 0) << "it waited for its first command";
  channel_.stop(StopReason::stale, 20 * kMs);
  channel_.stop(StopReason::silent, 25 * kMs);
  command(0.5, 0, 50 * kMs);
  EXPECT_EQ(channel_.stopped_time(), 30 * kMs);
  channel_.stop(StopReason::stale, 60 * kMs);
  channel_.stop(StopReason::ended, 100 * kMs);
  EXPECT_EQ(channel_.stopped_time(), 70 * kMs);
}

TEST_F(CommandChannelTest, silence_stops_until_the_next_tick) {
  command(0.5, 0.1, 0);
  EXPECT_EQ(next_, 100 * kMs);
  EXPECT_EQ(channel_.poll(100 * kMs), 200 * kMs);
  EXPECT_EQ(sent_.size(), 2u);
  EXPECT_EQ(channel_.stop(StopReason::silent, 150 * kMs), 250 * kMs);
  EXPECT_THAT(sent_.back(), ElementsAre(0, 0));
  for (TimeNs t = 151 * kMs; t <= 1000 * kMs; t += kMs) {
    channel_.poll(t);
  }
  EXPECT_EQ(sent_.size(), 3u + 8) << "repeated at 250, 350, ..., 950 ms";
  EXPECT_THAT(sent_.back(), ElementsAre(0, 0));
  command(0.5, 0.1, 1001 * kMs);
  EXPECT_THAT(sent_.back(), ElementsAre(0.5, 0.1));
  EXPECT_EQ(count("resumed"), 1u);
  EXPECT_EQ(count("commands"), 3u);
  EXPECT_EQ(count("stops_no_tick"), 1u);
}

TEST_F(CommandChannelTest, requests_from_outside_always_send_a_zero) {
  channel_.stop(StopReason::continued, 0);
  channel_.stop(StopReason::continued, 0);
  EXPECT_THAT(sent_, ElementsAre(ElementsAre(0, 0), ElementsAre(0, 0)));
}

// mpirun sends SIGCONT when a program has died, and SIGTERM a second later: in between, the loop
// may go on ticking.
TEST_F(CommandChannelTest, after_a_continue_no_command_until_mpirun_would_have_ended_the_job) {
  const double forward[] = {1.0, 0.0};
  channel_.command(forward, 0);
  channel_.stop(StopReason::continued, 10 * kMs);
  EXPECT_EQ(channel_.standing().stopped, StopReason::continued);
  channel_.command(forward, 20 * kMs);
  EXPECT_THAT(sent_, ElementsAre(ElementsAre(1, 0), ElementsAre(0, 0)));
  channel_.command(forward, kContinuedPause + 9 * kMs);
  EXPECT_THAT(sent_.back(), ElementsAre(0, 0));
  channel_.command(forward, kContinuedPause + 10 * kMs);
  EXPECT_THAT(sent_.back(), ElementsAre(1, 0));
  EXPECT_EQ(channel_.standing().stopped, std::nullopt);
}

// A process that was stopped finds its last tick long past, and its data old.
TEST_F(CommandChannelTest, no_other_stop_shortens_the_pause_after_a_continue) {
  for (const StopReason reason : {StopReason::silent, StopReason::stale, StopReason::no_value}) {
    const TimeNs begin = 10 * kContinuedPause * static_cast<int>(reason);
    command(1, 0, begin);
    channel_.stop(StopReason::continued, begin + 10 * kMs);
    channel_.stop(reason, begin + 11 * kMs);
    command(1, 0, begin + 12 * kMs);
    command(1, 0, begin + kContinuedPause + 9 * kMs);
    EXPECT_THAT(sent_.back(), ElementsAre(0, 0)) << stop_reason_name(reason);
    command(1, 0, begin + kContinuedPause + 10 * kMs);
    EXPECT_THAT(sent_.back(), ElementsAre(1, 0)) << stop_reason_name(reason);
  }
}

TEST_F(CommandChannelTest, zeros_are_repeated_after_a_continue_until_a_command) {
  command(1, 0, 0);
  channel_.stop(StopReason::continued, 10 * kMs);
  for (TimeNs t = 11 * kMs; t <= 2010 * kMs; t += kMs) {
    channel_.poll(t);
  }
  EXPECT_EQ(sent_.size(), 1u + 1 + 20);
  EXPECT_THAT(sent_.back(), ElementsAre(0, 0));
  command(1, 0, 2011 * kMs);
  EXPECT_THAT(sent_.back(), ElementsAre(1, 0));
}

TEST_F(CommandChannelTest, zeros_are_repeated_in_the_pause_after_a_continue) {
  command(1, 0, 0);
  channel_.stop(StopReason::continued, 10 * kMs);
  channel_.stop(StopReason::stale, 11 * kMs);
  command(1, 0, 12 * kMs);
  EXPECT_EQ(next_, 111 * kMs);
  command(1, 0, 110 * kMs);
  channel_.poll(111 * kMs);
  EXPECT_THAT(sent_, ElementsAre(ElementsAre(1, 0), ElementsAre(0, 0), ElementsAre(0, 0),
                                 ElementsAre(0, 0)));
}

TEST_F(CommandChannelTest, nothing_leaves_after_the_end) {
  for (const StopReason reason : {StopReason::terminated, StopReason::ended}) {
    std::vector<std::vector<double>> sent;
    CommandChannel channel({.gate = {{0.02}, kMs, kMs}},
                           [&](auto values) { sent.emplace_back(values.begin(), values.end()); });
    const double forward[] = {1.0};
    channel.command(forward, 0);
    channel.stop(reason, 1);
    EXPECT_EQ(channel.command(forward, 5 * kMs), kNever);
    EXPECT_EQ(channel.poll(50 * kMs), kNever);
    channel.stop(StopReason::continued, 60 * kMs);
    EXPECT_THAT(sent, ElementsAre(ElementsAre(1.0), ElementsAre(0.0)));
  }
}

}  // namespace
}  // namespace command_channel_test
