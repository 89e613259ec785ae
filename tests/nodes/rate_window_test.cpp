// Counts against counting.
#include <cmath>

#include "spike_trains.hpp"

namespace spikeloop::testing {
namespace {

using Keys = std::map<std::string, std::string>;

std::vector<double> counted(const std::vector<Spike>& spikes, std::size_t channels, TimeNs now,
                            TimeNs window) {
  std::vector<double> rates(channels, 0.0);
  for (const Spike& spike : spikes) {
    if (spike.time_ns > now - window && spike.time_ns <= now) {
      rates[static_cast<std::size_t>(spike.channel)] += 1;
    }
  }
  for (double& rate : rates) {
    rate /= to_seconds(window);
  }
  return rates;
}

void expect_rates(const std::vector<double>& seen, const std::vector<double>& expected,
                  TimeNs now) {
  ASSERT_EQ(seen.size(), expected.size());
  for (std::size_t c = 0; c < seen.size(); ++c) {
    ASSERT_NEAR(seen[c], expected[c], 1e-9 * (1 + expected[c])) << c << " at " << now;
  }
}

TEST(RateWindow, CountsExactlyAtEveryTickAndWindow) {
  const auto spikes = random_spikes(2000, 3, 2 * kNsPerSecond);
  for (const TimeNs window : {kMs / 2, 10 * kMs, 33 * kMs, 100 * kMs, 5 * kNsPerSecond}) {
    for (const TimeNs tick : {kMs / 10, kMs, 10 * kMs, 50 * kMs}) {
      NodeHarness node("rate_window", {3, 3},
                       {.keys = {{"window", std::to_string(window) + " ns"}}});
      play(node, spikes, 2 * kNsPerSecond, tick, [&] {
        if (node.time() % (50 * kMs) == 0) {
          expect_rates(node.output(), counted(spikes, 3, node.time(), window), node.time());
        }
      });
      EXPECT_EQ(node.counter("spikes"), 2000U);
    }
  }
}

TEST(RateWindow, TheWindowIsOpenOnTheLeftAndClosedOnTheRight) {
  NodeHarness node("rate_window", {1, 1});
  node.run_until(9 * kMs, kMs);
  EXPECT_EQ(node.output()[0], 0.0);
  EXPECT_EQ(node.revision(), 1U) << "no spike is 0 Hz, from the first tick on";
  node.add_spike(10 * kMs, 0);
  node.step(kMs);
  EXPECT_DOUBLE_EQ(node.output()[0], 10.0);
  node.run_until(109 * kMs, kMs);
  EXPECT_DOUBLE_EQ(node.output()[0], 10.0);
  EXPECT_EQ(node.revision(), 2U) << "no news, no revision";
  node.step(kMs);
  EXPECT_EQ(node.output()[0], 0.0);
  EXPECT_EQ(node.revision(), 3U);
}

TEST(RateWindow, LateSpikesCountWithTheirTrueTime) {
  std::mt19937_64 generator(4);
  std::vector<Spike> all;
  NodeHarness node("rate_window", {4, 4}, {.keys = {{"window", "40 ms"}}});
  std::uint64_t late = 0;
  while (node.time() < kNsPerSecond) {
    for (int i = 0; i < 5; ++i) {
      const TimeNs age = static_cast<TimeNs>(generator() % (60 * kMs));  // up to 59 ms late
      const TimeNs time = std::max<TimeNs>(1, node.time() + kMs - age);
      all.push_back(make_spike(time, static_cast<std::int32_t>(generator() % 4)));
      node.add_spike(time, all.back().channel);
      late += time <= node.time() ? 1 : 0;
    }
    node.step(kMs);
    expect_rates(node.output(), counted(all, 4, node.time(), 40 * kMs), node.time());
  }
  EXPECT_EQ(node.counter("late_spikes"), late);
  EXPECT_EQ(node.counter("spikes"), all.size());
}

TEST(RateWindow, WhatDoesNotFitIsRefused) {
  EXPECT_THAT(message_of([] {
                NodeHarness("rate_window", {1, 1}, {.keys = {{"window", "0"}}});
              }),
              Fault("test.yaml:7:3: key 'window': 0 ... 1e-06 to 1000000 s ... [SL0203]"));
  NodeHarness node("rate_window", {2, 2});
  node.add_spike(kMs, -1);
  EXPECT_THAT(message_of([&] { node.step(kMs); }),
              Fault("a spike came on channel -1 ... 'in' ... 0 to 1 ..."));
}

}  // namespace
}  // namespace spikeloop::testing
