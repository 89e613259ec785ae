// What a tick brings: sensors and spikes that a command depends on fall silent, each at its time.
#include "spikeloop/command/command_feed.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <optional>

namespace spikeloop::command::command_feed_test {
namespace {

using testing::ElementsAre;

constexpr TimeNs kMs = 1'000'000;

/// Ticks of 10 ms of a feed with two sensors, of which the first is the data_stamp's.
class CommandFeedTest : public testing::Test {
 protected:
  struct Tick {
    TimeNs now = 0;
    std::optional<TimeNs> first{};  ///< when the newest messages came
    std::optional<TimeNs> second{};
    bool spike = false;
  };

  void take(CommandFeed& feed, const Tick& tick) {
    const auto arrived = [](std::optional<TimeNs> time, double& seconds) {
      seconds = to_seconds(time.value_or(0));
      return spikeloop_signal_input{&seconds, time ? 1U : 0U, 1, 0};
    };
    double value = 0.5;
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
    feed.take(Step(data), tick.now);
  }

  FeedSettings settings(TimeNs first, TimeNs second, TimeNs spikes = 0) const {
    return {.width = 1,
            .with_data_stamp = true,
            .max_age = 1000 * kMs,
            .sensors = {{"/scan", first}, {"/odom", second}},
            .spike_widths = {1},
            .spike_timeout = spikes};
  }

  CommandChannel channel_{{{{0.02}, kMs, 0}}, [this](auto values) { sent_.push_back(values[0]); }};
  std::vector<double> sent_;
};

TEST_F(CommandFeedTest, ports_are_as_many_as_what_is_watched) {
  const CommandFeed feed(settings(kMs, kMs), channel_);
  std::vector<std::string> names;
  for (const EndpointPort& port : feed.ports()) {
    names.push_back(port.name);
  }
  EXPECT_THAT(names, ElementsAre("command", "data_stamp", "sensor_0", "sensor_1", "spikes_0"));
}

TEST_F(CommandFeedTest, a_sensor_that_falls_silent_stops_the_robot_until_it_comes_back) {
  CommandFeed feed(settings(500 * kMs, 200 * kMs), channel_);
  take(feed, {.now = 1000 * kMs, .first = 990 * kMs, .second = 1000 * kMs});
  EXPECT_THAT(sent_, ElementsAre(0.5));
  take(feed, {.now = 1200 * kMs, .first = 1200 * kMs, .second = 1000 * kMs});
  EXPECT_EQ(channel_.stopped_by(), std::nullopt);
  take(feed, {.now = 1210 * kMs, .first = 1200 * kMs, .second = 1000 * kMs});
  EXPECT_THAT(sent_, ElementsAre(0.5, 0));
  EXPECT_EQ(channel_.stopped_by(), StopReason::sensor_silent);
  EXPECT_EQ(feed.silent_sensor().topic, "/odom");
  take(feed, {.now = 1220 * kMs, .first = 1200 * kMs, .second = 1220 * kMs});
  EXPECT_THAT(sent_, ElementsAre(0.5, 0, 0.5));
  take(feed, {.now = 1710 * kMs, .first = 1200 * kMs, .second = 1710 * kMs});
  EXPECT_EQ(channel_.stopped_by(), StopReason::sensor_silent);
  EXPECT_EQ(feed.silent_sensor().topic, "/scan");
}

TEST_F(CommandFeedTest, nothing_leaves_before_every_sensor_has_been_heard) {
  CommandFeed feed(settings(500 * kMs, 200 * kMs), channel_);
  take(feed, {.now = 1000 * kMs, .first = 1000 * kMs});
  EXPECT_TRUE(sent_.empty());
  take(feed, {.now = 1010 * kMs, .first = 1000 * kMs, .second = 1010 * kMs});
  EXPECT_THAT(sent_, ElementsAre(0.5));
}

TEST_F(CommandFeedTest, a_sensor_without_timeout_may_be_silent) {
  CommandFeed feed(settings(500 * kMs, 0), channel_);
  take(feed, {.now = 1000 * kMs, .first = 1000 * kMs});
  EXPECT_THAT(sent_, ElementsAre(0.5));
}

TEST_F(CommandFeedTest, old_data_stop_the_robot_though_every_sensor_is_heard) {
  FeedSettings rules = settings(5000 * kMs, 5000 * kMs);
  CommandFeed feed(rules, channel_);
  take(feed, {.now = 1000 * kMs, .first = 1000 * kMs, .second = 1000 * kMs});
  take(feed, {.now = 2010 * kMs, .first = 1000 * kMs, .second = 1000 * kMs});
  EXPECT_EQ(channel_.stopped_by(), StopReason::stale);
}

TEST_F(CommandFeedTest, a_silent_network_stops_the_robot_when_it_is_asked_for) {
  CommandFeed feed(settings(0, 0, 300 * kMs), channel_);
  const auto tick = [&](TimeNs now, bool spike) {
    take(feed, {.now = now, .first = now, .second = now, .spike = spike});
  };
  tick(1000 * kMs, false);
  tick(1300 * kMs, false);
  EXPECT_THAT(sent_, ElementsAre(0.5)) << "it has its time from the first tick on";
  tick(1310 * kMs, false);
  EXPECT_EQ(channel_.stopped_by(), StopReason::spikes_silent);
  tick(1320 * kMs, true);
  tick(1620 * kMs, false);
  EXPECT_THAT(sent_, ElementsAre(0.5, 0, 0.5));
  tick(1630 * kMs, false);
  EXPECT_THAT(sent_, ElementsAre(0.5, 0, 0.5, 0));
}

TEST_F(CommandFeedTest, a_network_may_be_silent_otherwise) {
  CommandFeed feed(settings(0, 0), channel_);
  for (TimeNs now = 1000 * kMs; now < 9000 * kMs; now += 10 * kMs) {
    take(feed, {.now = now, .first = now, .second = now});
  }
  EXPECT_EQ(channel_.stopped_by(), std::nullopt);
}

}  // namespace
}  // namespace spikeloop::command::command_feed_test
