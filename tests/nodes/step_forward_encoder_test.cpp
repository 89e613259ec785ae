// Steps of the base against a simulation that looks at every microsecond.
#include <cmath>

#include "sampled_signal.hpp"

namespace spikeloop::testing::step_forward_encoder_test {
namespace {

using Keys = std::map<std::string, std::string>;
constexpr TimeNs kUs = 1'000;

NodeHarness encoder(const Keys& keys = {}, std::uint32_t inputs = 1) {
  return {"step_forward_encoder", {inputs, 2 * inputs}, {.keys = keys}};
}

TEST(StepForwardEncoder, AJumpIsAsManySpikesAsItHasSteps) {
  NodeHarness node = encoder();
  node.set_input({0.0});
  node.run_until(10 * kMs, kMs);
  EXPECT_EQ(node.spike_count(), 0U) << "the first value is the base";
  node.set_input({0.35});
  node.run_until(30 * kMs, kMs);
  EXPECT_EQ(node.times(0), (std::vector<TimeNs>{10 * kMs + kUs, 11 * kMs + kUs, 12 * kMs + kUs}));
  EXPECT_EQ(node.times(1).size(), 0U);
  node.set_input({0.09});  // the base is 0.3
  node.run_until(60 * kMs, kMs);
  EXPECT_EQ(node.times(0).size(), 3U);
  EXPECT_EQ(node.times(1), (std::vector<TimeNs>{30 * kMs + kUs, 31 * kMs + kUs}));
  EXPECT_EQ(node.counter("spikes"), 5U);
}

TEST(StepForwardEncoder, TenStepsOfATenthAreOne) {
  NodeHarness node = encoder();
  node.set_input({0.0});
  node.step(kMs);
  node.set_input({1.0});
  node.run_until(100 * kMs, kMs);
  EXPECT_EQ(node.times(0).size(), 10U);
  node.set_input({0.0});
  node.run_until(200 * kMs, kMs);
  EXPECT_EQ(node.times(1).size(), 10U);
  EXPECT_EQ(node.times(0).size(), 10U);
}

TEST(StepForwardEncoder, ASlowRiseSpikesAtEachStep) {
  NodeHarness node = encoder({{"threshold", "0.25"}});
  std::vector<TimeNs> expected;
  for (int i = 0; i <= 100; ++i) {
    node.set_input({i / 64.0});
    if (i > 0 && i % 16 == 0) {
      expected.push_back(node.time() + kUs);
    }
    node.step(10 * kMs);
  }
  EXPECT_EQ(node.times(0), expected);
}

TEST(StepForwardEncoder, TheComparisonGoesOnWithANewValue) {
  NodeHarness node = encoder();
  node.set_input({0.0});
  node.step(kMs);
  node.set_input({1.0});
  node.step(5 * kMs / 2);  // three spikes: at 1.001, 2.001 and 3.001 ms
  ASSERT_EQ(node.times(0).size(), 3U);
  node.set_input({0.15});  // the base is 0.3: down, but not before 4.001 ms
  node.run_until(20 * kMs, kMs);
  EXPECT_EQ(node.times(0).size(), 3U);
  EXPECT_EQ(node.times(1), (std::vector<TimeNs>{4 * kMs + kUs}));
}

TEST(StepForwardEncoder, ASpikeThatIsDueStaysDueWhileTheInputGoesOn) {
  NodeHarness node = encoder();
  node.set_input({0.0});
  node.step(kMs);
  for (int i = 1; i <= 20; ++i) {  // a change every 0.4 us must not put the spike off for ever
    node.set_input({0.2 + 0.001 * i});
    node.step(400);
  }
  EXPECT_EQ(node.times(0), (std::vector<TimeNs>{kMs + kUs}));
}

TEST(StepForwardEncoder, InitialBaseIsComparedWithTheFirstValue) {
  NodeHarness node = encoder({{"initial_base", "0"}}, 2);
  node.run_until(3 * kMs, kMs);
  EXPECT_EQ(node.spike_count(), 0U);
  node.set_input({0.25, -0.15});
  node.run_until(10 * kMs, kMs);
  EXPECT_EQ(node.times(0), (std::vector<TimeNs>{3 * kMs + kUs, 4 * kMs + kUs}));
  EXPECT_EQ(node.times(3), (std::vector<TimeNs>{3 * kMs + kUs}));
  EXPECT_EQ(node.spike_count(), 3U);
}

struct Rule {
  double threshold;
  TimeNs min_interval;
};

// The definition, microsecond by microsecond, with a base that is really moved.
std::vector<Spike> simulated(const SampledSignal& signal, const Rule& rule) {
  std::vector<Spike> spikes;
  long double base = signal.values[0];
  TimeNs last = -rule.min_interval;
  TimeNs cause = 0;
  int direction = 0;
  const TimeNs end = signal.period * static_cast<TimeNs>(signal.values.size());
  for (TimeNs t = kUs; t <= end; t += kUs) {
    const auto segment = static_cast<std::size_t>((t - 1) / signal.period);
    const long double away = signal.values[segment] - base;
    const int now = away >= rule.threshold ? 1 : away <= -rule.threshold ? -1 : 0;
    if (now != direction) {
      direction = now;
      cause = t - kUs;
    }
    if (direction != 0 && t >= cause + kUs && t >= last + rule.min_interval) {
      spikes.push_back(make_spike(t, direction > 0 ? 0 : 1));
      base += direction * static_cast<long double>(rule.threshold);
      last = t;
    }
  }
  return spikes;
}

TEST(StepForwardEncoder, EqualsASimulationByTheMicrosecond) {
  for (const Rule rule : {Rule{0.11, kMs}, Rule{0.04, 700 * kUs}, Rule{0.3, 10 * kMs},
                          Rule{0.013, 100 * kUs}, Rule{0.07, 1'333 * kUs}}) {
    for (const TimeNs period : {kMs, 5 * kMs}) {
      const SampledSignal signal = noise(100, period, 11);
      const std::vector<Spike> expected = simulated(signal, rule);
      NodeHarness node = encoder({{"threshold", std::to_string(rule.threshold)},
                                  {"min_interval", std::to_string(rule.min_interval) + " ns"}});
      drive(node, signal, kMs / 2);
      ASSERT_GT(expected.size(), 5U);
      const std::vector<Spike> seen = node.spikes();
      ASSERT_EQ(seen.size(), expected.size()) << rule.threshold;
      for (std::size_t i = 0; i < seen.size(); ++i) {
        ASSERT_EQ(seen[i].time_ns, expected[i].time_ns) << rule.threshold << ", spike " << i;
        ASSERT_EQ(seen[i].channel, expected[i].channel) << rule.threshold << ", spike " << i;
      }
    }
  }
}

TEST(StepForwardEncoder, AddingUpTheSpikesGivesTheInput) {
  const SampledSignal signal = noise(200, 100 * kMs);
  NodeHarness node = encoder({{"threshold", "0.05"}, {"initial_base", "0"}});
  for (std::size_t i = 0; i < signal.values.size(); ++i) {
    node.set_input({signal.values[i]});
    node.step(signal.period);
    const double steps =
        static_cast<double>(node.times(0).size()) - static_cast<double>(node.times(1).size());
    ASSERT_LT(std::fabs(signal.values[i] - 0.05 * steps), 0.05 + 1e-12) << i;
  }
}

TEST(StepForwardEncoder, SpikesDoNotDependOnTheTick) {
  const SampledSignal signal = noise(100, 50 * kMs);
  std::vector<std::vector<TimeNs>> reference;
  for (const TimeNs tick : {50 * kMs, 10 * kMs, kMs, kMs / 10}) {
    for (const bool revise : {false, true}) {
      NodeHarness node = encoder({{"threshold", "0.013"}, {"min_interval", "0.9 ms"}}, 3);
      drive(node, signal, tick, revise, 3);
      std::vector<std::vector<TimeNs>> all;
      for (std::int32_t c = 0; c < 6; ++c) {
        all.push_back(node.times(c));
      }
      EXPECT_GT(all[0].size(), 1000U);
      reference = reference.empty() ? all : reference;
      EXPECT_EQ(all, reference) << "tick " << tick << " ns, revisions " << revise;
    }
  }
}

TEST(StepForwardEncoder, IsSilentWithoutAValueAndKeepsTheBase) {
  NodeHarness node = encoder();
  node.set_input({0.0});
  node.step(kMs);
  node.set_input({0.5});
  node.step(2 * kMs);  // two of five spikes
  EXPECT_EQ(node.spike_count(), 2U);
  node.invalidate_input();
  node.step(100 * kMs);
  EXPECT_EQ(node.spike_count(), 2U);
  node.set_input({std::nan("")});  // still no value
  node.step(100 * kMs);
  EXPECT_EQ(node.spike_count(), 2U);
  node.set_input({0.5});
  node.step(100 * kMs);
  EXPECT_EQ(node.times(0).size(), 5U);
  EXPECT_EQ(node.times(0)[2], 203 * kMs + kUs);
}

TEST(StepForwardEncoder, NumbersThatAreNoneAreHeld) {
  NodeHarness node = encoder({}, 2);
  node.set_input({std::nan(""), 0.0});
  node.step(10 * kMs);
  node.set_input({0.7, HUGE_VAL});  // the first value of channel 0
  node.step(10 * kMs);
  node.set_input({std::nan(""), 0.0});
  node.step(10 * kMs);
  EXPECT_EQ(node.spike_count(), 0U);
  EXPECT_EQ(node.counter("inputs_not_finite"), 3U);
  NodeHarness strict = encoder({{"not_finite", "error"}});
  strict.set_input({std::nan("")});
  EXPECT_THAT(message_of([&] { strict.step(kMs); }),
              Fault("input channel 0 has the value nan ... not_finite = hold"));
}

TEST(StepForwardEncoder, AHugeJumpDoesNotStallTheRun) {
  NodeHarness node = encoder({{"threshold", "1e-9"}, {"min_interval", "1 us"}});
  node.set_input({-1.7e308});
  node.step(kMs);
  node.set_input({1.7e308});
  node.step(50 * kMs);
  EXPECT_EQ(node.times(0).size(), 50'000U) << "one a microsecond";
}

TEST(StepForwardEncoder, WhatDoesNotFitIsRefused) {
  EXPECT_EQ(message_of([] {
              NodeHarness("step_forward_encoder", {3, 3});
            }),
            "port 'in' has 3 channels and port 'out' 3; write [6] in the connection of 'out': up "
            "and down of each value [SL0306]");
  EXPECT_THAT(message_of([] {
                encoder({{"threshold", "0"}});
              }),
              Fault("test.yaml:7:3: key 'threshold': 0 ... 1e-09 to 1000000000 ... [SL0203]"));
  EXPECT_THAT(message_of([] {
                encoder({{"min_interval", "0"}});
              }),
              Fault("test.yaml:7:3: key 'min_interval': 0 ... 1e-06 to 1000 s ... [SL0203]"));
  EXPECT_THAT(message_of([] {
                encoder({{"initial_base", "first"}});
              }),
              Fault("test.yaml:7:3: key 'initial_base': 'first' ... 'none' ... or none for each "
                    "channel's first value ... [SL0201]"));
}

}  // namespace
}  // namespace spikeloop::testing::step_forward_encoder_test
