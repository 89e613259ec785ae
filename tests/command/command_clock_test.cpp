// A command sink that goes by simulated time: how long a tick takes on the wall does not matter.
#include <gtest/gtest.h>
#include <signal.h>
#include <unistd.h>

#include <chrono>
#include <functional>
#include <string>
#include <thread>
#include <vector>

#include "spikeloop/command/command_settings.hpp"
#include "spikeloop/command/command_sink.hpp"

namespace spikeloop::command {
namespace {

using namespace std::chrono_literals;

constexpr TimeNs kMs = 1'000'000;

class CommandClockTest : public testing::Test {
 protected:
  CommandClockTest() { Watch::block_signals(); }

  /// Commands with these rules: repeated every 10 ms, at most 100 ms old.
  CommandSettings settings(CommandClock clock) const {
    return {.width = 1,
            .with_pace = true,
            .gate = {.deadband = {0.1}, .min_interval = kMs, .period = 10 * kMs},
            .watchdog = 50 * kMs,
            .max_age = 100 * kMs,
            .clock = clock};
  }
  CommandSink::Carrier carrier() {
    return {.publish = [this](auto values) { sent_.emplace_back(values[0]); },
            .finish = [] {},
            .interrupted = [] {}};
  }
  /// The tick of 1 ms that ends then, with a command from data of `arrived`.
  static void tick(CommandSink& sink, TimeNs end, double value, TimeNs arrived) {
    const double pace = to_seconds(arrived);
    spikeloop_signal_input inputs[2] = {};
    inputs[0].values = &value;
    inputs[1].values = &pace;
    for (auto& input : inputs) {
      input.width = 1;
      input.revision = 1;
    }
    spikeloop_step data{};  // ports command, pace
    data.begin_ns = end - kMs;
    data.end_ns = end;
    data.signal_inputs = inputs;
    data.signal_input_count = 2;
    sink.send(Step(data));
  }

  std::vector<double> sent_;
};

std::uint64_t counter(const CommandSink& sink, const std::string& name) {
  for (const Counter& entry : sink.counters()) {
    if (entry.name == name) {
      return entry.value;
    }
  }
  return 0;
}

TEST_F(CommandClockTest, RepetitionsAndAgesAreSimulated) {
  CommandSink sink(settings(CommandClock::simulated), carrier());
  for (TimeNs end = kMs; end <= 100 * kMs; end += kMs) {
    tick(sink, end, 0.5, 0);
  }
  EXPECT_EQ(sent_, std::vector<double>(10, 0.5)) << "at 1, 11, ..., 91 ms";
  tick(sink, 101 * kMs, 0.5, 0);
  EXPECT_EQ(sent_.back(), 0) << "older than 100 ms";
  EXPECT_EQ(counter(sink, "stops_data_too_old"), 1U);
}

TEST_F(CommandClockTest, ALoopThatWaitsIsNotSilent) {
  CommandSink sink(settings(CommandClock::simulated), carrier());
  sink.alive();
  tick(sink, kMs, 0.5, 0);
  for (int i = 0; i < 30; ++i) {
    std::this_thread::sleep_for(10ms);
    sink.alive();
  }
  tick(sink, 2 * kMs, 0.7, 0);
  EXPECT_EQ(counter(sink, "stops_no_tick"), 0U);
  EXPECT_EQ(sent_, (std::vector<double>{0.5, 0.7}));
}

TEST_F(CommandClockTest, ALoopThatHangsIsSilent) {
  CommandSink sink(settings(CommandClock::simulated), carrier());
  tick(sink, kMs, 0.5, 0);
  for (int i = 0; i < 1000 && counter(sink, "stops_no_tick") == 0; ++i) {
    std::this_thread::sleep_for(10ms);
  }
  EXPECT_EQ(counter(sink, "stops_no_tick"), 1U);
  EXPECT_EQ(sent_.back(), 0);
}

TEST_F(CommandClockTest, InLockstepNothingButTheTicksCounts) {
  CommandSink sink(settings(CommandClock::lockstep), carrier());
  tick(sink, kMs, 0.5, 0);
  ::kill(::getpid(), SIGCONT);
  std::this_thread::sleep_for(300ms);
  tick(sink, 2 * kMs, 0.7, 0);
  EXPECT_EQ(counter(sink, "stops_no_tick"), 0U);
  EXPECT_EQ(counter(sink, "stops_continued"), 0U);
  EXPECT_EQ(sent_, (std::vector<double>{0.5, 0.7}));
  sink.stop(StopReason::ended);
  EXPECT_EQ(sent_.back(), 0);
}

TEST_F(CommandClockTest, LockstepHasNoWatchdogForTheGuardEither) {
  Parameters keys;
  keys.set("deadband", 0.01);
  keys.set("command_rate", 20.0);
  keys.set("min_interval", 0.002);
  keys.set("watchdog", 0.1);
  keys.set("max_age", 1.0);
  const ComponentMap map({Component{}});
  const auto simulated = simulated_settings(keys, map, CommandClock::simulated, true);
  EXPECT_EQ(simulated.gate.min_interval, 2 * kMs);
  EXPECT_EQ(simulated.gate.period, 50 * kMs);
  EXPECT_EQ(simulated.watchdog, 100 * kMs);
  EXPECT_GT(simulated_settings(keys, map, CommandClock::lockstep, true).watchdog,
            TimeNs{3600} * 24 * 365 * kNsPerSecond);
}

}  // namespace
}  // namespace spikeloop::command
