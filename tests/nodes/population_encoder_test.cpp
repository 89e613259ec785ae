// Gaussian receptive fields: the rate of each neuron against the formula, spikes against theory.
#include <cmath>
#include <numbers>

#include "sampled_signal.hpp"
#include "statistics.hpp"

namespace spikeloop::testing {
namespace {

using Keys = std::map<std::string, std::string>;

// Spikes a second of each neuron, counted over 100 s of a constant input.
std::vector<double> rates(const std::vector<double>& x, std::uint32_t outputs, const Keys& keys) {
  NodeHarness node("population_encoder", {static_cast<std::uint32_t>(x.size()), outputs},
                   {.keys = keys});
  node.set_input(x);
  node.run_until(100 * kNsPerSecond, 100 * kMs);
  std::vector<double> counts(outputs, 0.0);
  for (const Spike& spike : node.spikes()) {
    counts[static_cast<std::size_t>(spike.channel)] += 0.01;
  }
  return counts;
}

double gauss(double away, double sigma) {
  return std::exp(-(away * away) / (2 * sigma * sigma));
}

constexpr double kCounting = 0.0101;  // Hz: one spike in 100 s

TEST(PopulationEncoder, RatesAreGaussiansOfTheDistance) {
  const Keys keys = {{"rate_min", "3"}, {"rate_max", "80"}, {"sigma", "0.3"}};
  const std::vector<double> x = {0.2, -0.9};
  const std::vector<double> seen = rates(x, 10, keys);
  for (std::size_t d = 0; d < 2; ++d) {
    for (std::size_t i = 0; i < 5; ++i) {
      const double mu = -1 + 0.5 * static_cast<double>(i);
      EXPECT_NEAR(seen[5 * d + i], 3 + 77 * gauss(x[d] - mu, 0.3), kCounting) << d << " " << i;
    }
  }
}

TEST(PopulationEncoder, WidthIsTwoThirdsOfTheSpacingUnlessWritten) {
  const auto expect_sigma = [](std::uint32_t neurons, const Keys& keys, double mu, double sigma) {
    const double x = mu + sigma;
    EXPECT_NEAR(rates({x}, neurons, keys)[0], 100 * std::exp(-0.5), kCounting) << neurons;
  };
  expect_sigma(9, {}, -1, 0.25 / 1.5);
  expect_sigma(9, {{"sigma", "auto"}}, -1, 0.25 / 1.5);
  expect_sigma(3, {{"value_min", "10"}, {"value_max", "16"}}, 10, 3 / 1.5);
  expect_sigma(2, {}, -1, 2 / 1.5);
  expect_sigma(1, {}, 0, 2 / 1.5);  // it prefers the middle
  expect_sigma(8, {{"circular", "true"}}, -1, 0.25 / 1.5);
}

TEST(PopulationEncoder, AnglesGoRoundTheCircle) {
  const Keys keys = {{"circular", "true"},
                     {"value_min", "-3.141592653589793"},
                     {"value_max", "3.141592653589793"},
                     {"sigma", "0.5"}};
  const double pi = std::numbers::pi;
  for (const double x : {0.0, 3.0, -3.1, 3.141592653589793, 9.0, -40.0}) {
    const std::vector<double> seen = rates({x}, 6, keys);
    for (int i = 0; i < 6; ++i) {
      double nearest = 1e9;
      for (int turns = -10; turns <= 10; ++turns) {
        nearest = std::min(nearest, std::fabs(x - (-pi + i * pi / 3) + turns * 2 * pi));
      }
      EXPECT_NEAR(seen[static_cast<std::size_t>(i)], 100 * gauss(nearest, 0.5), kCounting)
          << x << " " << i;
    }
  }
}

TEST(PopulationEncoder, ValuesFarOutsideTheRangeAreSilent) {
  for (const double x : {50.0, -1e6, 1e300, -1.7e308}) {
    for (const double rate : rates({x}, 4, {})) {
      EXPECT_EQ(rate, 0.0) << x;
    }
  }
}

// With fields much wider than the range every neuron has rate_max: the spikes of the encoders whose
// exactness has tests of its own.
TEST(PopulationEncoder, SpikesAreThoseOfTheRateAndThePoissonEncoder) {
  for (const auto& [spikes, other] :
       {std::pair{"regular", "rate_encoder"}, std::pair{"poisson", "poisson_encoder"}}) {
    NodeHarness population("population_encoder", {1, 20},
                           {.keys = {{"sigma", "1e9"}, {"spikes", spikes}}, .seed = 7});
    NodeHarness reference(other, {20, 20}, {.seed = 7});
    population.set_input({0.4});
    reference.set_input(std::vector<double>(20, 1.0));
    population.run_until(kNsPerSecond, kMs);
    reference.run_until(kNsPerSecond, kMs);
    ASSERT_EQ(population.spike_count(), reference.spike_count()) << spikes;
    for (std::int32_t c = 0; c < 20; ++c) {
      EXPECT_EQ(population.times(c), reference.times(c)) << spikes << " " << c;
    }
  }
}

TEST(PopulationEncoder, PoissonIntervalsAreExponential) {
  NodeHarness node("population_encoder", {1, 3},
                   {.keys = {{"spikes", "poisson"}, {"sigma", "0.8"}, {"rate_max", "200"}}});
  node.set_input({0.3});
  node.run_until(50 * kNsPerSecond, 10 * kMs);
  for (std::int32_t i = 0; i < 3; ++i) {
    const double rate = 200 * gauss(0.3 - (i - 1), 0.8);
    std::vector<double> intervals;
    TimeNs last = 0;
    for (const TimeNs time : node.times(i)) {
      intervals.push_back(to_seconds(time - last));
      last = time;
    }
    ASSERT_GT(intervals.size(), 500U);
    const double distance = kolmogorov_smirnov(
        intervals, [rate](double interval) { return 1 - std::exp(-rate * interval); });
    EXPECT_LT(distance, 1.95 / std::sqrt(static_cast<double>(intervals.size()))) << i;
  }
}

TEST(PopulationEncoder, RegularSpikesStandWhereTheIntegralOfTheRateIsWhole) {
  const SampledSignal signal = noise(500, 10 * kMs);
  NodeHarness node("population_encoder", {1, 5}, {.keys = {{"rate_max", "300"}}});
  drive(node, signal, 10 * kMs);
  for (std::int32_t i = 0; i < 5; ++i) {
    std::vector<double> theory;
    long double integral = 0;
    for (std::size_t k = 0; k < signal.values.size(); ++k) {
      const long double rate = 300.0 * gauss(signal.values[k] - (-1 + 0.5 * i), 0.5 / 1.5);
      const long double next = integral + rate * 0.01L;
      for (long double whole = std::floor(integral) + 1; whole <= next; ++whole) {
        theory.push_back(static_cast<double>(
            (static_cast<long double>(k) * 0.01L + (whole - integral) / rate) * 1e9L));
      }
      integral = next;
    }
    const std::vector<TimeNs> times = node.times(i);
    ASSERT_NEAR(static_cast<double>(times.size()), static_cast<double>(theory.size()), 1.0);
    for (std::size_t k = 0; k < std::min(times.size(), theory.size()); ++k) {
      ASSERT_NEAR(static_cast<double>(times[k]), theory[k], 2.0) << i << " " << k;
    }
  }
}

TEST(PopulationEncoder, SpikesDoNotDependOnTheTick) {
  const SampledSignal signal = noise(100, 50 * kMs);
  for (const char* spikes : {"regular", "poisson"}) {
    std::vector<TimeNs> reference;
    for (const TimeNs tick : {50 * kMs, 10 * kMs, kMs, kMs / 10}) {
      for (const bool revise : {false, true}) {
        NodeHarness node("population_encoder", {2, 8}, {.keys = {{"spikes", spikes}}});
        drive(node, signal, tick, revise, 2);
        std::vector<TimeNs> all;
        for (std::int32_t c = 0; c < 8; ++c) {
          const auto times = node.times(c);
          all.insert(all.end(), times.begin(), times.end());
        }
        reference = reference.empty() ? all : reference;
        EXPECT_GT(all.size(), 500U);
        EXPECT_EQ(all, reference) << spikes << ", tick " << tick << " ns, revisions " << revise;
      }
    }
  }
}

TEST(PopulationEncoder, IsSilentWithoutAValue) {
  NodeHarness node("population_encoder", {1, 4}, {.keys = {{"rate_min", "50"}}});
  node.run_until(kNsPerSecond, 10 * kMs);
  EXPECT_EQ(node.spike_count(), 0U);
  node.set_input({0.0});
  node.run_until(2 * kNsPerSecond, 10 * kMs);
  const std::size_t before = node.spike_count();
  EXPECT_GT(before, 200U);
  node.invalidate_input();
  node.run_until(3 * kNsPerSecond, 10 * kMs);
  EXPECT_EQ(node.spike_count(), before);
  EXPECT_EQ(node.counter("spikes"), before);
}

TEST(PopulationEncoder, InitialIsTheValueUntilTheFirstOneComes) {
  NodeHarness initial("population_encoder", {1, 3}, {.keys = {{"initial", "0.25"}}});
  NodeHarness given("population_encoder", {1, 3});
  given.set_input({0.25});
  initial.run_until(kNsPerSecond, kMs);
  given.run_until(kNsPerSecond, kMs);
  EXPECT_GT(initial.spike_count(), 50U);
  EXPECT_EQ(initial.times(1), given.times(1));
  initial.set_input({50});
  initial.step(10 * kMs);
  EXPECT_EQ(initial.spike_count(), given.spike_count());
}

TEST(PopulationEncoder, NumbersThatAreNoneAreHeld) {
  NodeHarness node("population_encoder", {2, 6});
  NodeHarness reference("population_encoder", {2, 6});
  node.set_input({0.5, std::nan("")});
  reference.set_input({0.5, 1e6});  // silent
  node.step(100 * kMs);
  reference.step(100 * kMs);
  node.set_input({-HUGE_VAL, 0.1});
  reference.set_input({0.5, 0.1});
  node.run_until(kNsPerSecond, 10 * kMs);
  reference.run_until(kNsPerSecond, 10 * kMs);
  for (std::int32_t c = 0; c < 6; ++c) {
    EXPECT_EQ(node.times(c), reference.times(c)) << c;
  }
  EXPECT_EQ(node.counter("inputs_not_finite"), 2U);
}

TEST(PopulationEncoder, WhatDoesNotFitIsRefused) {
  const auto failure = [](const Keys& keys, std::uint32_t in, std::uint32_t out) {
    return message_of([&] { NodeHarness("population_encoder", {in, out}, {.keys = keys}); });
  };
  EXPECT_EQ(failure({}, 3, 10),
            "port 'out' has 10 channels and port 'in' 3; make 'out' a multiple of 3 wide: as many "
            "neurons for each value [SL0306]");
  EXPECT_THAT(failure({}, 3, 2),
              Fault("port 'out' has 2 ... 'in' 3; make 'out' ... 3 wide: ... [SL0306]"));
  EXPECT_EQ(failure({{"value_min", "1"}}, 1, 4),
            "test.yaml:7:3: key 'value_min': 1 is not below value_max, 1; write value_min below "
            "value_max [SL0206]");
  EXPECT_THAT(failure({{"sigma", "wide"}}, 1, 4),
              Fault("test.yaml:7:3: key 'sigma': 'wide' ... 'auto' ... 0, or auto ... [SL0201]"));
  for (const char* sigma : {"0", "-1", "1e-10"}) {
    EXPECT_THAT(failure({{"sigma", sigma}}, 1, 4),
                Fault(std::string("test.yaml:7:3: key 'sigma': ") + sigma +
                      " is out of bounds; write a number of at least 1e-09, or auto [SL0203]"));
  }
  EXPECT_THAT(failure({{"initial", "inf"}}, 1, 4),
              Fault("test.yaml:7:3: key 'initial': 'inf' ... 'none' ... [SL0201]"));
  EXPECT_THAT(failure({{"spikes", "bursts"}}, 1, 4),
              Fault("test.yaml:7:3: key 'spikes': 'bursts' ... regular, poisson ... [SL0205]"));
}

}  // namespace
}  // namespace spikeloop::testing
