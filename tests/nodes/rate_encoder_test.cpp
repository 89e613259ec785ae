#include <cmath>

#include "regular_encoder_tests.hpp"
#include "statistics.hpp"

namespace spikeloop::testing {
namespace {

INSTANTIATE_TEST_SUITE_P(BuiltIn, RegularEncoder,
                         ::testing::Values(EncoderClass{"rate_encoder",
                                                        [] { return built_in("rate_encoder"); }}));

TEST(RateEncoder, InitialValueHoldsUntilTheFirstOneComes) {
  NodeHarness node("rate_encoder", {2, 2}, {.keys = {{"rate_min", "50"}, {"initial", "-1"}}});
  node.run_until(30 * kMs, 5 * kMs);
  EXPECT_EQ(node.times(0), std::vector<TimeNs>{20 * kMs});
  // Half of the interval of 20 ms is over; the other half takes 5 ms at 100 Hz.
  node.set_input({1.0, std::nan("")});
  node.run_until(40 * kMs, 5 * kMs);
  EXPECT_EQ(node.times(0), (std::vector<TimeNs>{20 * kMs, 35 * kMs}));
  EXPECT_EQ(node.times(1), (std::vector<TimeNs>{20 * kMs, 40 * kMs})) << "NaN holds the initial";
}

/// The spikes are those of the integral of the rate, which is 100 Hz, then 50 Hz, then 300 Hz.
TEST(RateEncoder, AChangedRateHoldsFromTheNextStepOn) {
  NodeHarness node("rate_encoder", {1, 1});
  node.set_input({1.0});
  node.run_until(15 * kMs, 5 * kMs);
  node.change("rate_max", 50);
  node.run_until(35 * kMs, 5 * kMs);
  EXPECT_EQ(node.times(0), (std::vector<TimeNs>{10 * kMs, 25 * kMs}));
  node.set_input({0.0});
  node.change("rate_max", 400);
  node.change("rate_min", 200);
  node.run_until(45 * kMs, 5 * kMs);
  // Half of an interval is over at 35 ms; the rest takes 1/600 s, then 1/300 s each.
  EXPECT_EQ(node.times(0).size(), 5U);
  EXPECT_NEAR(static_cast<double>(node.times(0)[2]), 35e6 + 1e9 / 600, 2);
  EXPECT_NEAR(static_cast<double>(node.times(0)[4]), 35e6 + 1e9 / 600 + 2e9 / 300, 2);
}

TEST(RateEncoder, AChangedRateHoldsForTheInitialValueToo) {
  NodeHarness node("rate_encoder", {1, 1}, {.keys = {{"initial", "1"}}});
  node.run_until(20 * kMs, 5 * kMs);
  node.change("rate_max", 1000);
  node.run_until(25 * kMs, 5 * kMs);
  EXPECT_EQ(node.times(0).size(), 2U + 5U);
}

TEST(RateEncoder, InitialValueIsNotUsedWhenTheFirstOneIsThereAtOnce) {
  NodeHarness node("rate_encoder", {1, 1}, {.keys = {{"initial", "1"}}});
  node.set_input({-1.0});
  node.run_until(kNsPerSecond, kMs);
  EXPECT_EQ(node.spike_count(), 0U);
}

TEST(RateEncoder, RandomPhasesAreUniformAndKeyedByNameAndSeed) {
  const auto phases_of = [](const std::string& name, std::uint64_t seed) {
    NodeHarness node("rate_encoder", {2000, 2000},
                     {.keys = {{"initial_phase", "random"}}, .name = name, .seed = seed});
    node.set_input(std::vector<double>(2000, 1.0));
    node.step(10 * kMs);
    EXPECT_EQ(node.spike_count(), 2000U) << "one spike a channel and interspike interval";
    std::vector<double> phases(2000, 0.0);
    for (const Spike& spike : node.spikes()) {
      phases[static_cast<std::size_t>(spike.channel)] =
          static_cast<double>(spike.time_ns) / (10.0 * kMs);
    }
    return phases;
  };
  const std::vector<double> phases = phases_of("a", 1);
  EXPECT_LT(kolmogorov_smirnov(phases, [](double x) { return x; }), 1.95 / std::sqrt(2000.0));
  EXPECT_EQ(phases, phases_of("a", 1));
  EXPECT_NE(phases, phases_of("b", 1));
  EXPECT_NE(phases, phases_of("a", 2));
}

TEST(RateEncoder, Defect5NegativeRatesAreSilentAndEnd) {
  for (const char* range : {"clip", "pass"}) {
    NodeHarness node("rate_encoder", {2, 2}, {.keys = {{"out_of_range", range}}});
    node.set_input({-1.2, -1e300});
    node.run_until(kNsPerSecond, kMs);
    EXPECT_EQ(node.spike_count(), 0U) << range;
    node.set_input({1.0, 1.0});
    node.run_until(2 * kNsPerSecond, kMs);
    EXPECT_EQ(node.times(0).size(), 100U) << range;
    EXPECT_EQ(node.times(1).size(), 100U) << range;
  }
}

TEST(RateEncoder, PassExtrapolatesWithinTheLimitsOfStamps) {
  NodeHarness node("rate_encoder", {3, 3}, {.keys = {{"out_of_range", "pass"}}});
  node.set_input({3.0, 1e12, -3.0});
  node.step(10 * kMs);
  EXPECT_EQ(node.times(0).size(), 2U) << "200 Hz";
  EXPECT_EQ(node.times(1).size(), 10'000U) << "1 MHz";
  EXPECT_EQ(node.times(2).size(), 0U);
  EXPECT_EQ(node.counter("rates_limited"), 2U);
  EXPECT_EQ(node.counter("inputs_clipped"), 0U);
}

}  // namespace
}  // namespace spikeloop::testing
