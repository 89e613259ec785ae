// What every encoder to regular spikes does, whoever wrote it: the tests take its class. It has the
// parameters rate_min and rate_max, and nothing else is asked of it.
#pragma once

#include <cmath>
#include <functional>
#include <numbers>

#include "sampled_signal.hpp"

namespace spikeloop::testing {

struct EncoderClass {
  const char* name;
  std::function<NodeClass()> get;
};
inline void PrintTo(const EncoderClass& encoder, std::ostream* out) {
  *out << encoder.name;
}

class RegularEncoder : public ::testing::TestWithParam<EncoderClass> {
 protected:
  static NodeHarness make(const std::vector<std::uint32_t>& widths,
                          const NodeOptions& options = {}) {
    return {GetParam().get(), widths, options};
  }
};

// What theory says of one channel: spikes where the integral of the rate passes 1, 2, 3, ...; in
// long double, from the signal alone.
inline std::vector<long double> theoretical_times(const SampledSignal& signal, long double rate_min,
                                                  long double rate_max) {
  std::vector<long double> times;
  long double integral = 0;
  for (std::size_t i = 0; i < signal.values.size(); ++i) {
    const long double rate =
        (rate_min + (signal.values[i] + 1.0L) / 2 * (rate_max - rate_min)) * 1e-9L;
    const long double begin = static_cast<long double>(signal.period) * static_cast<long double>(i);
    const long double next = integral + rate * static_cast<long double>(signal.period);
    for (long double whole = std::floor(integral) + 1; whole <= next; ++whole) {
      times.push_back(begin + (whole - integral) / rate);
    }
    integral = next;
  }
  return times;
}

inline long double integral_of(const SampledSignal& signal, long double rate_max) {
  long double integral = 0;
  for (const double x : signal.values) {
    integral += (x + 1.0L) / 2 * rate_max * static_cast<long double>(signal.period) * 1e-9L;
  }
  return integral;
}

inline void expect_near_theory(const std::vector<TimeNs>& times,
                               const std::vector<long double>& theory) {
  // A spike within rounding of the end may fall on either side of it.
  ASSERT_NEAR(static_cast<double>(times.size()), static_cast<double>(theory.size()), 1.0);
  for (std::size_t i = 0; i < std::min(times.size(), theory.size()); ++i) {
    ASSERT_NEAR(static_cast<double>(static_cast<long double>(times[i]) - theory[i]), 0.0, 1.0)
        << "spike " << i;
  }
}

TEST_P(RegularEncoder, ConstantInputGivesSpikesAtMultiplesOfTheInterval) {
  NodeHarness node = make({3, 3}, {.keys = {{"rate_max", "300 Hz"}}});
  node.set_input({1.0, 0.0, -1.0});
  node.run_until(100 * kNsPerSecond, 100 * kMs);
  const std::vector<TimeNs> fast = node.times(0);
  ASSERT_EQ(fast.size(), 30'000U);
  for (std::size_t k = 0; k < fast.size(); ++k) {
    ASSERT_EQ(fast[k], std::llround(static_cast<long double>(k + 1) * 1e9L / 300)) << k;
  }
  EXPECT_EQ(node.times(1).size(), 15'000U);
  EXPECT_TRUE(node.times(2).empty());
  EXPECT_EQ(node.counter("spikes"), 45'000U);
}

TEST_P(RegularEncoder, RoundingDoesNotAddUpOverMillionsOfSpikes) {
  // An interval of 10000.9000810... ns: rounding each one up would be 0.3 s at the end. Half a
  // nanosecond is the stamps', the rest is that of three million intervals kept to 1e-6 ns.
  NodeHarness node = make({1, 1}, {.keys = {{"rate_max", "99991"}}});
  node.set_input({1.0});
  std::int64_t k = 0;
  while (node.time() < 30 * kNsPerSecond) {
    node.step(10 * kMs);
    for (const Spike& spike : node.take_spikes()) {
      ++k;
      const long double theory = static_cast<long double>(k) * 1e9L / 99991;
      ASSERT_NEAR(static_cast<double>(static_cast<long double>(spike.time_ns) - theory), 0.0, 2);
    }
  }
  EXPECT_EQ(k, 30 * 99991);
}

TEST_P(RegularEncoder, RateIsLinearBetweenItsBounds) {
  NodeHarness node = make({3, 3}, {.keys = {{"rate_min", "20"}, {"rate_max", "60"}}});
  node.set_input({-1.0, 0.5, 1.0});
  node.run_until(10 * kNsPerSecond, 10 * kMs);
  EXPECT_EQ(node.times(0).size(), 200U);
  EXPECT_EQ(node.times(1).size(), 500U);
  EXPECT_EQ(node.times(2).size(), 600U);
}

TEST_P(RegularEncoder, RateMayFallWithTheInput) {
  NodeHarness node = make({2, 2}, {.keys = {{"rate_min", "100"}, {"rate_max", "10"}}});
  node.set_input({-1.0, 1.0});
  node.run_until(10 * kNsPerSecond, 10 * kMs);
  EXPECT_EQ(node.times(0).size(), 1000U);
  EXPECT_EQ(node.times(1).size(), 100U);
}

TEST_P(RegularEncoder, StepsFollowTheory) {
  const SampledSignal signal{100 * kMs, {-1, 1, -0.5, 0.25, -1, -1, 0.9, 1, 0.1, -0.99, 1}};
  NodeHarness node = make({1, 1}, {.keys = {{"rate_max", "37"}}});
  drive(node, signal, 10 * kMs);
  expect_near_theory(node.times(), theoretical_times(signal, 0, 37));
}

TEST_P(RegularEncoder, SampledSineFollowsTheory) {
  SampledSignal signal{kMs, {}};
  for (int i = 0; i < 5000; ++i) {
    signal.values.push_back(std::sin(2 * std::numbers::pi * 1.7 * i * 1e-3));
  }
  NodeHarness node = make({1, 1}, {.keys = {{"rate_min", "5"}, {"rate_max", "211"}}});
  drive(node, signal, kMs);
  expect_near_theory(node.times(), theoretical_times(signal, 5, 211));
}

TEST_P(RegularEncoder, Defect17PhaseIsConservedWhenTheRateChanges) {
  // The older encoders lost 5.5 % of the spikes with changes every 10 ms, 7.4 % every 1 ms.
  for (const TimeNs period : {10 * kMs, kMs}) {
    const SampledSignal signal = noise(3000, period);
    NodeHarness node = make({1, 1});
    drive(node, signal, period);
    EXPECT_NEAR(static_cast<double>(node.spike_count()),
                static_cast<double>(integral_of(signal, 100)), 1.0);
    expect_near_theory(node.times(), theoretical_times(signal, 0, 100));
  }
}

TEST_P(RegularEncoder, SpikeTimesDoNotDependOnTheTick) {
  const SampledSignal signal = noise(20, 50 * kMs);
  std::vector<TimeNs> reference;
  for (const TimeNs tick : {50 * kMs, 10 * kMs, kMs, kMs / 10}) {
    for (const bool revise : {false, true}) {
      NodeHarness node = make({1, 1}, {.keys = {{"rate_max", "333"}}});
      drive(node, signal, tick, revise);
      if (reference.empty()) {
        reference = node.times();
        EXPECT_GT(reference.size(), 150U);
      }
      EXPECT_EQ(node.times(), reference) << "tick " << tick << " ns, revisions " << revise;
    }
  }
}

TEST_P(RegularEncoder, Defect16SeveralSpikesInOneIntervalKeepTheirTimes) {
  NodeHarness node = make({1, 1}, {.keys = {{"rate_max", "1 kHz"}}});
  node.set_input({1.0});
  node.step(5 * kMs);
  EXPECT_EQ(node.times(), (std::vector<TimeNs>{kMs, 2 * kMs, 3 * kMs, 4 * kMs, 5 * kMs}));
}

TEST_P(RegularEncoder, SpikeOnABorderBelongsToTheIntervalBefore) {
  NodeHarness node = make({1, 1}, {.keys = {{"rate_max", "100"}}});
  node.set_input({1.0});
  node.run_until(9 * kMs, kMs);
  EXPECT_EQ(node.spike_count(), 0U);
  node.step(kMs);
  EXPECT_EQ(node.times(), std::vector<TimeNs>{10 * kMs});
  node.step(kMs);
  EXPECT_EQ(node.spike_count(), 1U);
}

TEST_P(RegularEncoder, IsSilentUntilTheFirstValue) {
  NodeHarness node = make({1, 1}, {.keys = {{"rate_min", "50"}}});
  node.run_until(995 * kMs, 5 * kMs);
  EXPECT_EQ(node.spike_count(), 0U);
  node.set_input({1.0});
  node.run_until(1005 * kMs, 5 * kMs);
  EXPECT_EQ(node.times(), std::vector<TimeNs>{1005 * kMs}) << "the phase is 0 at the first value";
}

TEST_P(RegularEncoder, AnInvalidInputSilencesAndKeepsThePhase) {
  NodeHarness node = make({1, 1});
  node.set_input({1.0});
  node.run_until(15 * kMs, kMs);
  node.invalidate_input();
  node.run_until(1000 * kMs, kMs);
  EXPECT_EQ(node.times(), std::vector<TimeNs>{10 * kMs});
  node.set_input({1.0});
  node.run_until(1005 * kMs, kMs);
  EXPECT_EQ(node.times(), (std::vector<TimeNs>{10 * kMs, 1005 * kMs}));
}

TEST_P(RegularEncoder, Defect18SpikeDueWhenTheRateBecomesZeroDoesNotSilence) {
  // At 100 Hz a spike is due at exactly 10 ms, the tick when the rate drops to 0.
  for (const TimeNs off : {10 * kMs, 10 * kMs - 1, 10 * kMs + 1}) {
    NodeHarness node = make({1, 1});
    node.set_input({1.0});
    node.step(off);
    const std::size_t before = off >= 10 * kMs ? 1 : 0;
    EXPECT_EQ(node.spike_count(), before);
    node.set_input({-1.0});
    node.run_until(100 * kMs, kMs);
    EXPECT_EQ(node.spike_count(), before);
    node.set_input({1.0});
    node.run_until(200 * kMs, kMs);
    EXPECT_EQ(node.spike_count(), before + 10);
    EXPECT_EQ(node.times().back(), (before == 0 ? 190 * kMs : 200 * kMs) + 10 * kMs - off);
  }
}

TEST_P(RegularEncoder, RatesNextToZeroStaySilentAndHarmless) {
  NodeHarness node = make({4, 4}, {.keys = {{"rate_max", "1e-300"}}});
  for (int i = 0; i < 1000; ++i) {
    node.set_input({i % 2 == 0 ? -1.0 : 1.0, 0.1 * (i % 7), -1.0, 1e-310});
    node.step(kNsPerSecond);
  }
  EXPECT_EQ(node.spike_count(), 0U);
}

TEST_P(RegularEncoder, ManyChannelsSpikeAsOneAlone) {
  // Channels beyond the first block, and blocks of which only one channel is due.
  const SampledSignal signal = noise(50, 20 * kMs);
  NodeHarness alone = make({1, 1});
  drive(alone, signal, kMs);
  NodeHarness many = make({200, 200});
  for (std::size_t i = 0; i < signal.values.size(); ++i) {
    std::vector<double> values(200, -1.0);
    for (const std::size_t c : {0, 63, 64, 130, 199}) {
      values[c] = signal.values[i];
    }
    many.set_input(values);
    many.run_until(signal.period * static_cast<TimeNs>(i + 1), kMs);
  }
  for (const std::int32_t c : {0, 63, 64, 130, 199}) {
    EXPECT_EQ(many.times(c), alone.times()) << c;
  }
  EXPECT_EQ(many.spike_count(), 5 * alone.spike_count());
}

}  // namespace spikeloop::testing
