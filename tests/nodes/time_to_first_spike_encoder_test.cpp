// Latencies against their formula.
#include <cmath>

#include "sampled_signal.hpp"

namespace spikeloop::testing::time_to_first_spike_encoder_test {
namespace {

using Keys = std::map<std::string, std::string>;

NodeHarness encoder(const Keys& keys = {}, std::uint32_t channels = 1) {
  return {"time_to_first_spike_encoder", {channels, channels}, {.keys = keys}};
}

// The latency of x in ns.
double latency(double x, double t_min = 1e6, double t_max = 50e6) {
  return t_min + (t_max - t_min) * (1 - x) / 2;
}

TEST(TimeToFirstSpikeEncoder, TheLargerTheValueTheEarlierTheSpike) {
  const std::vector<double> x = {1, 0.5, 0, -0.3, -1};
  NodeHarness node = encoder({}, 5);
  node.set_input(x);
  node.run_until(kNsPerSecond, 10 * kMs);
  for (std::size_t c = 0; c < x.size(); ++c) {
    const std::vector<TimeNs> times = node.times(static_cast<std::int32_t>(c));
    ASSERT_EQ(times.size(), 10U) << "one a window";
    for (std::size_t k = 0; k < 10; ++k) {
      EXPECT_NEAR(static_cast<double>(times[k] - static_cast<TimeNs>(k) * 100 * kMs), latency(x[c]),
                  0.51)
          << c;
    }
  }
  EXPECT_EQ(node.times(0)[3], 301 * kMs);
  EXPECT_EQ(node.times(4)[3], 350 * kMs);
  EXPECT_EQ(node.counter("spikes"), 50U);
}

TEST(TimeToFirstSpikeEncoder, TheValueAtTheBeginOfTheWindowCounts) {
  NodeHarness node = encoder();
  node.step(40 * kMs);
  node.set_input({0.5});  // within the first window
  node.step(60 * kMs);
  EXPECT_EQ(node.spike_count(), 0U);
  node.set_input({0.0});  // at the begin of the second
  node.step(20 * kMs);
  node.set_input({1.0});  // within it
  node.step(180 * kMs);
  EXPECT_EQ(node.times(), (std::vector<TimeNs>{125'500'000, 201 * kMs}));
}

TEST(TimeToFirstSpikeEncoder, FollowsASampledSignalAtEveryTick) {
  const SampledSignal signal = noise(100, 50 * kMs);
  std::vector<TimeNs> expected;
  for (TimeNs start = 0; start < 5 * kNsPerSecond; start += 20 * kMs) {
    const double x = signal.values[static_cast<std::size_t>(start / signal.period)];
    if (x >= -0.5) {
      expected.push_back(start + std::llround(latency(x, 2e6, 20e6)));
    }
  }
  for (const TimeNs tick : {50 * kMs, 10 * kMs, kMs, kMs / 10}) {
    for (const bool revise : {false, true}) {
      NodeHarness node = encoder(
          {{"period", "20 ms"}, {"t_min", "2 ms"}, {"t_max", "20 ms"}, {"threshold", "-0.5"}});
      drive(node, signal, tick, revise);
      const std::vector<TimeNs> times = node.times();
      ASSERT_EQ(times.size(), expected.size()) << tick;
      for (std::size_t i = 0; i < times.size(); ++i) {
        ASSERT_LE(std::abs(times[i] - expected[i]), 1) << "tick " << tick << ", spike " << i;
      }
    }
  }
}

TEST(TimeToFirstSpikeEncoder, ASpikeAtTheBeginOfTheNextWindowIsNotLost) {
  for (const TimeNs tick : {kMs, 7 * kMs, 10 * kMs, 45 * kMs}) {
    NodeHarness node = encoder({{"period", "10 ms"}, {"t_max", "10 ms"}});
    node.set_input({-1.0});
    node.run_until(90 * kMs, tick);
    std::vector<TimeNs> expected;
    for (TimeNs t = 10 * kMs; t <= 90 * kMs; t += 10 * kMs) expected.push_back(t);
    EXPECT_EQ(node.times(), expected) << tick;
  }
}

TEST(TimeToFirstSpikeEncoder, ValuesBelowTheThresholdGiveNone) {
  NodeHarness node = encoder({{"threshold", "0.2"}}, 3);
  node.set_input({0.2, 0.1999, -1});
  node.run_until(300 * kMs, kMs);
  EXPECT_EQ(node.times(0).size(), 3U);
  EXPECT_EQ(node.spike_count(), 3U);
}

TEST(TimeToFirstSpikeEncoder, ValuesOutsideTheRangeFollowThePolicy) {
  NodeHarness clipped = encoder({}, 2);
  clipped.set_input({7, -7});
  clipped.run_until(100 * kMs, kMs);
  EXPECT_EQ(clipped.times(0), std::vector<TimeNs>{kMs});
  EXPECT_EQ(clipped.times(1), std::vector<TimeNs>{50 * kMs});
  EXPECT_EQ(clipped.counter("inputs_clipped"), 2U);
  NodeHarness passed = encoder({{"out_of_range", "pass"}}, 4);
  passed.set_input({1.02, -1.5, 1e300, -1e300});
  passed.run_until(100 * kMs, kMs);
  EXPECT_NEAR(static_cast<double>(passed.times(0)[0]), latency(1.02), 0.51);
  EXPECT_NEAR(static_cast<double>(passed.times(1)[0]), latency(-1.5), 0.51);
  EXPECT_EQ(passed.times(2), std::vector<TimeNs>{1'000}) << "not before 1 us";
  EXPECT_EQ(passed.times(3), std::vector<TimeNs>{100 * kMs}) << "not after the window";
  EXPECT_THAT(message_of([] {
                NodeHarness strict = encoder({{"out_of_range", "error"}});
                strict.set_input({2});
                strict.step(kMs);
              }),
              Fault("input channel 0 has the value 2 ... [-1, 1] ... out_of_range = clip"));
}

TEST(TimeToFirstSpikeEncoder, NumbersThatAreNoneAreHeld) {
  NodeHarness node = encoder({}, 2);
  node.set_input({0.0, std::nan("")});
  node.step(100 * kMs);
  node.set_input({std::nan(""), 1.0});
  node.step(100 * kMs);
  EXPECT_EQ(node.times(0), (std::vector<TimeNs>{25'500'000, 125'500'000}));
  EXPECT_EQ(node.times(1), (std::vector<TimeNs>{101 * kMs}));
  EXPECT_EQ(node.counter("inputs_not_finite"), 2U);
}

TEST(TimeToFirstSpikeEncoder, IsSilentWithoutAValue) {
  NodeHarness node = encoder();
  node.run_until(300 * kMs, kMs);
  EXPECT_EQ(node.spike_count(), 0U);
  node.set_input({-1.0});
  node.step(kMs);
  node.invalidate_input();
  node.run_until(kNsPerSecond, kMs);
  EXPECT_EQ(node.spike_count(), 0U) << "also in the window that has begun";
  node.set_input({-1.0});
  node.run_until(1'100 * kMs, kMs);
  EXPECT_EQ(node.times(), std::vector<TimeNs>{1'050 * kMs});
}

TEST(TimeToFirstSpikeEncoder, InitialIsTheValueUntilTheFirstOneComes) {
  NodeHarness node = encoder({{"initial", "0"}});
  node.run_until(120 * kMs, kMs);
  node.set_input({1.0});
  node.run_until(300 * kMs, kMs);
  EXPECT_EQ(node.times(), (std::vector<TimeNs>{25'500'000, 125'500'000, 201 * kMs}));
}

TEST(TimeToFirstSpikeEncoder, WhatDoesNotFitIsRefused) {
  const auto failure = [](const Keys& keys) { return message_of([&] { encoder(keys); }); };
  EXPECT_EQ(
      failure({{"t_min", "60 ms"}}),
      "test.yaml:7:3: key 't_min': 0.06 is above t_max, 0.05; write t_min at most t_max [SL0206]");
  EXPECT_EQ(failure({{"period", "20 ms"}}),
            "test.yaml:7:3: key 't_max': 0.05 is above period, 0.02; write t_max at most period "
            "[SL0206]");
  EXPECT_THAT(failure({{"t_min", "0"}}),
              Fault("test.yaml:7:3: key 't_min': 0 ... 1e-06 to 1000000 s ... [SL0203]"));
  EXPECT_THAT(failure({{"period", "0"}}),
              Fault("test.yaml:7:3: key 'period': 0 ... 1e-05 to 1000000 s ... [SL0203]"));
  EXPECT_THAT(failure({{"threshold", "low"}}),
              Fault("test.yaml:7:3: key 'threshold': 'low' ... 'none' ... -1 to 1, or none for a "
                    "spike of every value ... [SL0201]"));
  EXPECT_THAT(failure({{"initial", "2"}}),
              Fault("test.yaml:7:3: key 'initial': 2 ... -1 to 1 ... [SL0203]"));
}

}  // namespace
}  // namespace spikeloop::testing::time_to_first_spike_encoder_test
