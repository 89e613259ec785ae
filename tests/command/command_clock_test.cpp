// A command sink that goes by simulated time: how long a tick takes on the wall does not matter.
#include <gtest/gtest.h>
#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <functional>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "counter.hpp"
#include "spikeloop/command/command_settings.hpp"
#include "spikeloop/command/command_sink.hpp"

namespace spikeloop::command {
namespace {

using namespace std::chrono_literals;

constexpr TimeNs kMs = 1'000'000;

class CommandClockTest : public testing::Test, public CommandSink::Transport {
 protected:
  CommandClockTest() { Watch::block_signals(); }

  /// Commands with these rules: repeated every 10 ms, at most 100 ms old.
  CommandSettings settings(CommandClock clock) const {
    return {.with_data_stamp = true,
            .gate = {.deadband = {0.1}, .min_interval = kMs, .period = 10 * kMs},
            .watchdog = 50 * kMs,
            .max_age = 100 * kMs,
            .clock = clock};
  }
  void publish(std::span<const double> values) override {
    const std::lock_guard lock(mutex_);  // the watch publishes, too
    sent_.emplace_back(values[0]);
  }
  /// The tick of 1 ms that ends then, with a command from data of `arrived`.
  static void tick(CommandSink& sink, TimeNs end, double value, TimeNs arrived) {
    const double data_stamp = to_seconds(arrived);
    spikeloop_signal_input inputs[2] = {};
    inputs[0].values = &value;
    inputs[1].values = &data_stamp;
    for (auto& input : inputs) {
      input.width = 1;
      input.revision = 1;
    }
    spikeloop_step data{};  // ports command, data_stamp
    data.begin_ns = end - kMs;
    data.end_ns = end;
    data.signal_inputs = inputs;
    data.signal_input_count = 2;
    sink.send(Step(data));
  }

  std::vector<double> sent() {
    const std::lock_guard lock(mutex_);
    return sent_;
  }
  /// Waits until this many zeros, and nothing else, have followed the last command.
  bool zeros_follow(std::ptrdiff_t wanted) {
    const auto count = [this] {
      const std::vector<double> all = sent();
      const auto last = std::find_if(all.rbegin(), all.rend(), [](double v) { return v != 0; });
      return last - all.rbegin();
    };
    for (int i = 0; i < 1000 && count() < wanted; ++i) {
      std::this_thread::sleep_for(10ms);
    }
    return count() >= wanted;
  }

  std::mutex mutex_;
  std::vector<double> sent_;
};

TEST_F(CommandClockTest, RepetitionsAndAgesAreSimulated) {
  CommandSettings patient = settings(CommandClock::simulated);
  patient.watchdog = 60 * kNsPerSecond;  // a busy machine may hold up a tick
  CommandSink sink(patient, *this);
  for (TimeNs end = kMs; end <= 100 * kMs; end += kMs) {
    tick(sink, end, 0.5, 0);
  }
  EXPECT_EQ(sent(), std::vector<double>(10, 0.5)) << "at 1, 11, ..., 91 ms";
  tick(sink, 101 * kMs, 0.5, 0);
  EXPECT_EQ(sent().back(), 0) << "older than 100 ms";
  EXPECT_EQ(counter(sink, "stops_data_too_old"), 1U);
}

TEST_F(CommandClockTest, ALoopThatWaitsIsNotSilent) {
  CommandSettings waiting = settings(CommandClock::simulated);
  waiting.watchdog = 1000 * kMs;
  CommandSink sink(waiting, *this);
  sink.alive();
  tick(sink, kMs, 0.5, 0);
  for (int i = 0; i < 150; ++i) {
    std::this_thread::sleep_for(10ms);
    sink.alive();
  }
  tick(sink, 2 * kMs, 0.7, 0);
  EXPECT_EQ(counter(sink, "stops_no_tick"), 0U);
  EXPECT_EQ(sent(), (std::vector<double>{0.5, 0.7}));
}

TEST_F(CommandClockTest, ALoopThatHangsIsSilent) {
  CommandSink sink(settings(CommandClock::simulated), *this);
  tick(sink, kMs, 0.5, 0);
  for (int i = 0; i < 1000 && counter(sink, "stops_no_tick") == 0; ++i) {
    std::this_thread::sleep_for(10ms);
  }
  EXPECT_EQ(counter(sink, "stops_no_tick"), 1U);
  EXPECT_EQ(sent().back(), 0);
}

TEST_F(CommandClockTest, ZerosAreRepeatedWhileTheLoopHangs) {
  for (const CommandClock clock : {CommandClock::wall, CommandClock::simulated}) {
    CommandSettings hanging = settings(clock);
    hanging.gate.period = 0;
    hanging.max_age = 0;
    CommandSink sink(hanging, *this);
    tick(sink, kMs, 0.5, 0);
    EXPECT_TRUE(zeros_follow(5));
    EXPECT_EQ(counter(sink, "stops_no_tick"), 1U);
    sink.stop(StopReason::ended);
    const std::size_t before = sent().size();
    std::this_thread::sleep_for(250ms);
    EXPECT_EQ(sent().size(), before) << "nothing follows the end";
  }
}

TEST_F(CommandClockTest, ZerosAreRepeatedAfterAContinue) {
  CommandSettings continued = settings(CommandClock::wall);
  continued.max_age = 0;
  continued.watchdog = 60 * kNsPerSecond;
  CommandSink sink(continued, *this);
  tick(sink, kMs, 0.5, 0);
  ::kill(::getpid(), SIGCONT);
  EXPECT_TRUE(zeros_follow(5));
  EXPECT_EQ(counter(sink, "stops_continued"), 1U);
  EXPECT_EQ(counter(sink, "stops_no_tick"), 0U);
}

// A paused clock: the robot may still have missed the first zero.
TEST_F(CommandClockTest, ZerosOfTheEmergencyStopAreRepeatedWhileSimulatedTimeStandsStill) {
  CommandSettings paused = settings(CommandClock::simulated);
  paused.emergency_stop.topic = "/stop";
  paused.max_age = 0;
  paused.watchdog = 60 * kNsPerSecond;
  CommandSink sink(paused, *this);
  tick(sink, kMs, 0.5, 0);
  sink.emergency(true);
  EXPECT_TRUE(zeros_follow(5));
}

TEST_F(CommandClockTest, InLockstepNothingButTheTicksCounts) {
  CommandSink sink(settings(CommandClock::lockstep), *this);
  tick(sink, kMs, 0.5, 0);
  ::kill(::getpid(), SIGCONT);
  std::this_thread::sleep_for(300ms);
  tick(sink, 2 * kMs, 0.7, 0);
  EXPECT_EQ(counter(sink, "stops_no_tick"), 0U);
  EXPECT_EQ(counter(sink, "stops_continued"), 0U);
  EXPECT_EQ(sent(), (std::vector<double>{0.5, 0.7}));
  sink.stop(StopReason::ended);
  EXPECT_EQ(sent().back(), 0);
}

TEST_F(CommandClockTest, WhatPeopleSayCountsAtOnceByAnyOtherClock) {
  for (const CommandClock clock : {CommandClock::wall, CommandClock::simulated}) {
    CommandSettings with_topics = settings(clock);
    with_topics.emergency_stop.topic = "/stop";
    with_topics.manual.topic = "/by_hand";
    with_topics.gate = {.deadband = {0.1}};
    with_topics.watchdog = 60 * kNsPerSecond;
    with_topics.max_age = 0;
    sent_.clear();
    CommandSink sink(with_topics, *this);
    tick(sink, kMs, 0.5, 0);
    const double back = -0.3;
    sink.override_with({&back, 1});
    EXPECT_EQ(sent(), (std::vector<double>{0.5, -0.3}));
    sink.emergency(true);
    EXPECT_TRUE(zeros_follow(1));
    EXPECT_EQ(counter(sink, "stops_emergency_stop"), 1U);
    EXPECT_EQ(counter(sink, "overrides"), 1U);
  }
}

TEST_F(CommandClockTest, InLockstepWhatPeopleSayCountsFromTheNextTick) {
  CommandSettings with_topics = settings(CommandClock::lockstep);
  with_topics.emergency_stop.topic = "/stop";
  with_topics.manual = {.topic = "/by_hand", .timeout = 5 * kMs};
  CommandSink sink(with_topics, *this);
  tick(sink, kMs, 0.5, 0);
  const double back = -0.3;
  sink.override_with({&back, 1});
  EXPECT_EQ(sent(), std::vector<double>{0.5});
  tick(sink, 2 * kMs, 0.5, 0);
  EXPECT_EQ(sent(), (std::vector<double>{0.5, -0.3}));
  tick(sink, 6 * kMs, 0.5, 0);
  EXPECT_EQ(sent().back(), -0.3);
  tick(sink, 7 * kMs, 0.5, 0);
  EXPECT_EQ(sent().back(), 0.5) << "5 ms of simulated time are over";
  sink.emergency(true);
  EXPECT_EQ(sent().back(), 0.5);
  tick(sink, 8 * kMs, 0.5, 0);
  EXPECT_EQ(sent().back(), 0);
}

// The loop hangs, and a manual command is the last that anybody says.
TEST_F(CommandClockTest, AManualCommandEndsWithoutTheLoop) {
  CommandSettings with_topics = settings(CommandClock::wall);
  with_topics.manual = {.topic = "/by_hand", .timeout = 100 * kMs};
  with_topics.max_age = 0;
  CommandSink sink(with_topics, *this);
  tick(sink, kMs, 0.5, 0);
  for (int i = 0; i < 1000 && counter(sink, "stops_no_tick") == 0; ++i) {
    std::this_thread::sleep_for(10ms);
  }
  const double back = -0.3;
  sink.override_with({&back, 1});
  EXPECT_EQ(counter(sink, "overrides"), 1U);
  EXPECT_EQ(counter(sink, "resumed"), 1U);
  for (int i = 0; i < 1000 && counter(sink, "stops_no_tick") == 1; ++i) {
    std::this_thread::sleep_for(10ms);
  }
  EXPECT_EQ(counter(sink, "stops_no_tick"), 2U);
  sink.stop(StopReason::ended);
  EXPECT_EQ(sent().back(), 0);
}

// Nobody may say that he is gone: the watch looks.
TEST_F(CommandClockTest, ALostPublisherOfTheEmergencyStopIsNoticedWithoutAMessage) {
  CommandSettings with_topics = settings(CommandClock::wall);
  with_topics.emergency_stop = {.topic = "/stop", .required = true};
  with_topics.max_age = 0;
  with_topics.watchdog = 60 * kNsPerSecond;
  std::atomic<bool> there{true};
  CommandSink sink(with_topics, *this);
  sink.watch_publishers([&] { return there.load(); });
  for (int i = 0; i < 1000 && counter(sink, "commands") == 0; ++i) {
    tick(sink, kMs, 0.5, 0);
    std::this_thread::sleep_for(5ms);
  }
  ASSERT_GT(counter(sink, "commands"), 0U);
  const std::uint64_t before = counter(sink, "stops_emergency_stop_unknown");
  there = false;
  for (int i = 0; i < 1000 && counter(sink, "stops_emergency_stop_unknown") == before; ++i) {
    std::this_thread::sleep_for(10ms);
  }
  EXPECT_EQ(counter(sink, "stops_emergency_stop_unknown"), before + 1);
}

TEST_F(CommandClockTest, LockstepHasNoWatchdogForTheGuardEither) {
  Parameters keys;
  keys.set("deadband", 0.01);
  keys.set("command_rate", 20.0);
  keys.set("min_interval", 0.002);
  keys.set("watchdog", 0.1);
  keys.set("max_age", 1.0);
  keys.set("limits", std::string(kNoLimits));
  const CommandMapping mapping{.file = "", .message_type = "", .fields = {{.field = "data"}}};
  const auto simulated = command_settings(keys, mapping, 1, {CommandClock::simulated});
  EXPECT_EQ(simulated.gate.min_interval, 2 * kMs);
  EXPECT_EQ(simulated.gate.period, 50 * kMs);
  EXPECT_EQ(simulated.watchdog, 100 * kMs);
  EXPECT_GT(command_settings(keys, mapping, 1, {CommandClock::lockstep}).watchdog,
            TimeNs{3600} * 24 * 365 * kNsPerSecond);
}

}  // namespace
}  // namespace spikeloop::command
