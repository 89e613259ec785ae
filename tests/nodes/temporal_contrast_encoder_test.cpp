// Differences between successive values against the signal itself.
#include <cmath>

#include "sampled_signal.hpp"

namespace spikeloop::testing::temporal_contrast_encoder_test {
namespace {

using Keys = std::map<std::string, std::string>;
constexpr TimeNs kUs = 1'000;

NodeHarness encoder(const Keys& keys = {}, std::uint32_t inputs = 1) {
  return {"temporal_contrast_encoder", {inputs, 2 * inputs}, {.keys = keys}};
}

TEST(TemporalContrastEncoder, LargeDifferencesGiveASpike) {
  const SampledSignal signal = noise(500, 3 * kMs);
  for (const double threshold : {0.0, 0.1, 0.5, 1.5}) {
    std::vector<TimeNs> up;
    std::vector<TimeNs> down;
    for (std::size_t i = 1; i < signal.values.size(); ++i) {
      const double difference = signal.values[i] - signal.values[i - 1];
      const TimeNs stamp = signal.period * static_cast<TimeNs>(i) + kUs;
      if (difference > threshold) up.push_back(stamp);
      if (difference < -threshold) down.push_back(stamp);
    }
    NodeHarness node = encoder({{"threshold", std::to_string(threshold)}}, 2);
    drive(node, signal, kMs, false, 2);
    EXPECT_GT(up.size(), 0U);
    for (const std::int32_t input : {0, 1}) {
      EXPECT_EQ(node.times(2 * input), up) << threshold;
      EXPECT_EQ(node.times(2 * input + 1), down) << threshold;
    }
    EXPECT_EQ(node.counter("spikes"), 2 * (up.size() + down.size()));
  }
}

TEST(TemporalContrastEncoder, AnEqualDifferenceIsNotAboveTheThreshold) {
  NodeHarness node = encoder({{"threshold", "0.25"}});
  for (const double x : {0.0, 0.25, 0.0, 0.5, 0.25, 0.5000001}) {
    node.set_input({x});
    node.step(kMs);
  }
  EXPECT_EQ(node.times(0), (std::vector<TimeNs>{3 * kMs + kUs, 5 * kMs + kUs}));
  EXPECT_EQ(node.times(1).size(), 0U);
}

TEST(TemporalContrastEncoder, SmallChangesDoNotAddUp) {
  NodeHarness node = encoder();
  for (int i = 0; i < 100; ++i) {
    node.set_input({0.05 * i});
    node.step(kMs);
  }
  EXPECT_EQ(node.spike_count(), 0U);
}

TEST(TemporalContrastEncoder, SpikesDoNotDependOnTheTick) {
  const SampledSignal signal = noise(300, 50 * kMs);
  std::vector<TimeNs> reference;
  for (const TimeNs tick : {50 * kMs, 10 * kMs, kMs, kMs / 10}) {
    for (const bool revise : {false, true}) {
      NodeHarness node = encoder();
      drive(node, signal, tick, revise);
      std::vector<TimeNs> all = node.times(0);
      const std::vector<TimeNs> down = node.times(1);
      all.insert(all.end(), down.begin(), down.end());
      EXPECT_GT(all.size(), 200U);
      reference = reference.empty() ? all : reference;
      EXPECT_EQ(all, reference) << "tick " << tick << " ns, revisions " << revise;
    }
  }
}

TEST(TemporalContrastEncoder, NoSpikeIsLostAtTicksShorterThanTheReaction) {
  NodeHarness node = encoder();
  for (int i = 0; i < 20; ++i) {
    node.set_input({i % 2 == 0 ? 0.0 : 1.0});
    node.step(300);
  }
  node.step(kMs);
  std::vector<TimeNs> up;
  for (int i = 1; i < 20; i += 2) up.push_back(300 * i + kUs);
  EXPECT_EQ(node.times(0), up);
  EXPECT_EQ(node.times(1).size(), 9U);
}

TEST(TemporalContrastEncoder, TheFirstValueHasNoneBefore) {
  NodeHarness node = encoder();
  node.set_input({1.0});
  node.step(kMs);
  node.invalidate_input();
  node.step(kMs);
  node.set_input({-1.0});
  node.step(kMs);
  EXPECT_EQ(node.spike_count(), 0U);
  node.set_input({1.0});
  node.step(kMs);
  EXPECT_EQ(node.times(0), (std::vector<TimeNs>{3 * kMs + kUs}));
}

TEST(TemporalContrastEncoder, NumbersThatAreNoneAreNoValues) {
  NodeHarness node = encoder();
  for (const double x : {0.0, std::nan(""), 0.05, HUGE_VAL, 0.5}) {
    node.set_input({x});
    node.step(kMs);
  }
  EXPECT_EQ(node.times(0), (std::vector<TimeNs>{4 * kMs + kUs})) << "from 0.05 to 0.5";
  EXPECT_EQ(node.spike_count(), 1U);
  EXPECT_EQ(node.counter("inputs_not_finite"), 2U);
}

TEST(TemporalContrastEncoder, WhatDoesNotFitIsRefused) {
  EXPECT_THAT(message_of([] {
                NodeHarness("temporal_contrast_encoder", {2, 3});
              }),
              Fault("port 'in' has 2 ... 'out' 3 ... [4] ... 'out': ... [SL0306]"));
  EXPECT_THAT(message_of([] {
                encoder({{"threshold", "-0.1"}});
              }),
              Fault("test.yaml:7:3: key 'threshold': -0.1 ... 0 to 1000000000 ... [SL0203]"));
}

}  // namespace
}  // namespace spikeloop::testing::temporal_contrast_encoder_test
