// What a tick brings: sensors and spikes that a command depends on fall silent, each at its time.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <optional>

#include "spikeloop/command/command_sink.hpp"
#include "tests/support/fault.hpp"

namespace spikeloop::command::command_data_test {
namespace {

using test::Fault;
using testing::ElementsAre;

constexpr TimeNs kMs = 1'000'000;
constexpr bool kUnwatched = false;
constexpr const char* kDriven = "the robot is driven by the network";

/// Ticks of 10 ms of a sink with two sensors, of which the first is the data stamp's.
class CommandDataTest : public testing::Test, public CommandSink::Transport {
 protected:
  struct Tick {
    TimeNs now = 0;
    std::optional<TimeNs> first{};  ///< when the newest messages came
    std::optional<TimeNs> second{};
    bool spike = false;
    double value = 0.5;
  };

  static void take(CommandSink& sink, const Tick& tick) {
    const auto arrived = [](std::optional<TimeNs> time, double& seconds) {
      seconds = to_seconds(time.value_or(0));
      return spikeloop_signal_input{&seconds, time ? 1U : 0U, 1, 0};
    };
    const double value = tick.value;
    double first = 0;
    double second = 0;
    const spikeloop_signal_input signals[] = {{&value, 1, 1, 0},
                                              arrived(tick.first, first),
                                              arrived(tick.first, first),
                                              arrived(tick.second, second)};
    const Spike spike = make_spike(tick.now, 0);
    const spikeloop_spike_input spikes{&spike, tick.spike ? 1U : 0U, 1, 0};
    spikeloop_step data{};
    data.begin_ns = tick.now - 10 * kMs;
    data.end_ns = tick.now;
    data.signal_inputs = signals;
    data.signal_input_count = 4;
    data.spike_inputs = &spikes;
    data.spike_input_count = 1;
    sink.send(Step(data));
  }

  static CommandSettings settings(TimeNs first, TimeNs second, TimeNs spikes = 0) {
    return {.with_data_stamp = true,
            .gate = {.deadband = {0.02}, .min_interval = kMs},
            .max_age = 1000 * kMs,
            .clock = CommandClock::simulated,
            .sensors = {{"/scan", first}, {"/odom", second}},
            .spike_widths = {1},
            .spike_timeout = spikes};
  }

  void publish(std::span<const double> values) override { sent_.push_back(values[0]); }

  std::vector<double> sent_;
};

TEST_F(CommandDataTest, ports_are_as_many_as_what_is_watched) {
  const CommandSink sink(settings(kMs, kMs), *this, kUnwatched);
  std::vector<std::string> names;
  for (const EndpointPort& port : sink.ports()) {
    names.push_back(port.name);
  }
  EXPECT_THAT(names, ElementsAre("command", "data_stamp", "sensor_0", "sensor_1", "spikes_0"));
}

TEST_F(CommandDataTest, a_sensor_that_falls_silent_stops_the_robot_until_it_comes_back) {
  CommandSink sink(settings(500 * kMs, 200 * kMs), *this, kUnwatched);
  take(sink, {.now = 1000 * kMs, .first = 990 * kMs, .second = 1000 * kMs});
  EXPECT_THAT(sent_, ElementsAre(0.5));
  take(sink, {.now = 1200 * kMs, .first = 1200 * kMs, .second = 1000 * kMs});
  EXPECT_EQ(sink.condition().text, kDriven);
  take(sink, {.now = 1210 * kMs, .first = 1200 * kMs, .second = 1000 * kMs});
  EXPECT_THAT(sent_, ElementsAre(0.5, 0));
  EXPECT_THAT(sink.condition().text, Fault("the robot is stopped: ... '/odom' ... 200 ms"));
  take(sink, {.now = 1220 * kMs, .first = 1200 * kMs, .second = 1220 * kMs});
  EXPECT_THAT(sent_, ElementsAre(0.5, 0, 0.5));
  take(sink, {.now = 1710 * kMs, .first = 1200 * kMs, .second = 1710 * kMs});
  EXPECT_THAT(sink.condition().text, Fault("the robot is stopped: ... '/scan' ... 500 ms"));
}

TEST_F(CommandDataTest, nothing_leaves_before_every_sensor_has_been_heard) {
  CommandSink sink(settings(500 * kMs, 200 * kMs), *this, kUnwatched);
  take(sink, {.now = 1000 * kMs, .first = 1000 * kMs});
  EXPECT_TRUE(sent_.empty());
  take(sink, {.now = 1010 * kMs, .first = 1000 * kMs, .second = 1010 * kMs});
  EXPECT_THAT(sent_, ElementsAre(0.5));
}

TEST_F(CommandDataTest, a_sensor_without_timeout_may_be_silent) {
  CommandSink sink(settings(500 * kMs, 0), *this, kUnwatched);
  take(sink, {.now = 1000 * kMs, .first = 1000 * kMs});
  EXPECT_THAT(sent_, ElementsAre(0.5));
}

TEST_F(CommandDataTest, old_data_stop_the_robot_though_every_sensor_is_heard) {
  CommandSink sink(settings(5000 * kMs, 5000 * kMs), *this, kUnwatched);
  take(sink, {.now = 1000 * kMs, .first = 1000 * kMs, .second = 1000 * kMs});
  take(sink, {.now = 2010 * kMs, .first = 1000 * kMs, .second = 1000 * kMs});
  EXPECT_THAT(sink.condition().text, Fault("the robot is stopped: ... max_age, 1 s"));
}

TEST_F(CommandDataTest, a_silent_network_stops_the_robot_when_it_is_asked_for) {
  CommandSink sink(settings(0, 0, 300 * kMs), *this, kUnwatched);
  const auto tick = [&](TimeNs now, bool spike) {
    take(sink, {.now = now, .first = now, .second = now, .spike = spike});
  };
  tick(1000 * kMs, false);
  tick(1300 * kMs, false);
  EXPECT_THAT(sent_, ElementsAre(0.5)) << "it has its time from the first tick on";
  tick(1310 * kMs, false);
  EXPECT_THAT(sink.condition().text, Fault("the robot is stopped: ... spike_timeout, 300 ms"));
  tick(1320 * kMs, true);
  tick(1620 * kMs, false);
  EXPECT_THAT(sent_, ElementsAre(0.5, 0, 0.5));
  tick(1630 * kMs, false);
  EXPECT_THAT(sent_, ElementsAre(0.5, 0, 0.5, 0));
}

// A change that waits for min_interval counts until it leaves; a repetition delays no change.
TEST_F(CommandDataTest, latency_counts_to_the_sending_of_the_message) {
  CommandSettings slow = settings(0, 0);
  slow.gate.min_interval = 25 * kMs;
  CommandSink sink(slow, *this, kUnwatched);
  std::vector<double> latencies;
  sink.on_latency([&](TimeNs, double latency_ms) { latencies.push_back(latency_ms); });
  const auto tick = [&](TimeNs now, TimeNs arrived, double value) {
    take(sink, {.now = now * kMs, .first = arrived * kMs, .second = now * kMs, .value = value});
  };
  tick(1010, 1003, 0.1);
  EXPECT_THAT(latencies, ElementsAre(7));
  tick(1020, 1014, 0.5);
  EXPECT_THAT(latencies, ElementsAre(7)) << "held back";
  tick(1030, 1014, 0.5);
  tick(1040, 1014, 0.5);
  EXPECT_THAT(latencies, ElementsAre(7, 26));
  tick(1050, 1048, 0.5);
  EXPECT_THAT(latencies, ElementsAre(7, 26, 2)) << "the robot has this command already";
}

TEST_F(CommandDataTest, a_network_may_be_silent_otherwise) {
  CommandSink sink(settings(0, 0), *this, kUnwatched);
  for (TimeNs now = 1000 * kMs; now < 9000 * kMs; now += 10 * kMs) {
    take(sink, {.now = now, .first = now, .second = now});
  }
  EXPECT_EQ(sink.condition().text, kDriven);
}

}  // namespace
}  // namespace spikeloop::command::command_data_test
