#include <cmath>
#include <random>

#include "harness.hpp"

namespace spikeloop::testing {
namespace {

// The kernel sum as the paper writes it, in long double, from all spikes at once.
struct Direct {
  long double value = 0;
  long double scale = 0;  // the same sum with |w|: what relative accuracy refers to
};

Direct direct_sum(const std::vector<Spike>& spikes, const WeightTable& weights, std::uint32_t row,
                  double tau, TimeNs now) {
  Direct direct;
  for (const Spike& spike : spikes) {
    const long double age = static_cast<long double>(now - spike.time_ns) * 1e-9L;
    if (age < 0 || age > 60 * tau) {
      continue;  // exp(-60) is 1e-26
    }
    const long double trace = std::exp(-age / tau) / tau;
    const long double weight = weights.at(row, static_cast<std::uint32_t>(spike.channel));
    direct.value += weight * trace;
    direct.scale += std::fabs(weight) * trace;
  }
  return direct;
}

WeightTable random_weights(std::uint32_t rows, std::uint32_t columns, unsigned seed) {
  std::mt19937_64 generator(seed);
  std::normal_distribution<double> normal;
  std::vector<double> values(std::size_t{rows} * columns);
  for (double& value : values) {
    value = normal(generator);
  }
  return WeightTable::dense(rows, columns, values);
}

struct Run {
  double tau = 0.03;
  TimeNs tick = kMs;
  TimeNs length = kNsPerSecond;
  double spikes_per_tick = 1.0;
  TimeNs latest = 0;  // spikes may be this late
  TimeNs check_every = 10 * kMs;
  double tolerance = 1e-12;  // of the sum with |w|
};

// Random spikes; compares every output with the direct sum.
void expect_direct_sum(const Run& run, const WeightTable& weights) {
  NodeHarness node("linear_readout", {weights.columns, weights.rows},
                   {.keys = {{"tau", std::to_string(run.tau)}}, .weights = weights});
  std::mt19937_64 generator(5);
  std::poisson_distribution<int> count(run.spikes_per_tick);
  std::uniform_int_distribution<std::int32_t> channel(
      0, static_cast<std::int32_t>(weights.columns) - 1);
  std::vector<Spike> all;
  while (node.time() < run.length) {
    const TimeNs begin = node.time();
    std::uniform_int_distribution<TimeNs> when(std::max<TimeNs>(0, begin - run.latest) + 1,
                                               begin + run.tick);
    for (int i = count(generator); i > 0; --i) {
      all.push_back(make_spike(when(generator), channel(generator)));
      node.add_spike(all.back().time_ns, all.back().channel);
    }
    node.step(run.tick);
    if (node.time() % run.check_every == 0) {
      for (std::uint32_t row = 0; row < weights.rows; ++row) {
        const Direct direct = direct_sum(all, weights, row, run.tau, node.time());
        ASSERT_LE(std::fabs(static_cast<double>(node.output()[row] - direct.value)),
                  run.tolerance * static_cast<double>(direct.scale))
            << "row " << row << " at " << node.time();
      }
    }
  }
  EXPECT_EQ(node.counter("spikes"), all.size());
}

TEST(LinearReadout, EqualsTheDirectSum) {
  const WeightTable weights = random_weights(3, 20, 1);
  expect_direct_sum({.tick = kMs, .spikes_per_tick = 3}, weights);
  expect_direct_sum({.tick = 50 * kMs, .spikes_per_tick = 100, .check_every = 50 * kMs}, weights);
  expect_direct_sum({.tick = kMs / 10, .spikes_per_tick = 0.3}, weights);
}

TEST(LinearReadout, EqualsTheDirectSumWhenTicksAreLongerThanTau) {
  expect_direct_sum({.tau = 0.0005,
                     .tick = 50 * kMs,
                     .length = 5 * kNsPerSecond,
                     .spikes_per_tick = 300,
                     .check_every = 50 * kMs},
                    random_weights(2, 10, 2));
}

TEST(LinearReadout, DoesNotDriftOverManyTicks) {
  // 400,000 ticks within one tau: only what is added up exactly stays this near.
  expect_direct_sum({.tau = 100.0,
                     .tick = kMs / 10,
                     .length = 40 * kNsPerSecond,
                     .spikes_per_tick = 3,
                     .check_every = 10 * kNsPerSecond,
                     .tolerance = 2e-15},
                    WeightTable::dense(1, 10, std::vector<double>(10, 0.1)));
  expect_direct_sum({.tau = 0.03,
                     .tick = kMs,
                     .length = 200 * kNsPerSecond,
                     .spikes_per_tick = 0.5,
                     .check_every = 10 * kNsPerSecond},
                    random_weights(2, 10, 4));
}

TEST(LinearReadout, LateSpikesCountWithTheirTrueAge) {
  expect_direct_sum({.tick = kMs, .spikes_per_tick = 2, .latest = 80 * kMs},
                    random_weights(2, 10, 5));
  NodeHarness node("linear_readout", {1, 1}, {.weights = WeightTable::one_to_one()});
  node.run_until(50 * kMs, kMs);
  node.add_spike(20 * kMs, 0);  // late
  node.add_spike(50 * kMs, 0);  // at the begin: late as well
  node.add_spike(51 * kMs, 0);  // at the end: of this interval
  node.step(kMs);
  EXPECT_NEAR(node.output()[0], (std::exp(-31.0 / 30.0) + std::exp(-1.0 / 30.0) + 1.0) / 0.03,
              1e-12 / 0.03);
  EXPECT_EQ(node.counter("late_spikes"), 2U);
  EXPECT_EQ(node.counter("spikes"), 3U);
}

TEST(LinearReadout, SteadyRateIsReadInHertz) {
  // The mean over an interspike interval is exactly the rate; sampled in phase it is the sum of a
  // geometric series.
  NodeHarness node("linear_readout", {1, 1}, {.weights = WeightTable::one_to_one()});
  for (TimeNs t = 10 * kMs; t <= 2 * kNsPerSecond; t += 10 * kMs) {
    node.add_spike(t, 0);
    node.step(10 * kMs);
  }
  EXPECT_NEAR(node.output()[0], 1.0 / (1.0 - std::exp(-1.0 / 3.0)) / 0.03, 1e-10);
}

TEST(LinearReadout, UniformDefaultIsTheMean) {
  NodeHarness node("linear_readout", {4, 3});
  for (std::int32_t c = 0; c < 4; ++c) {
    node.add_spike(kMs, c);
  }
  node.step(kMs);
  for (const double value : node.output()) {
    EXPECT_NEAR(value, 1.0 / 0.03, 1e-12);
  }
}

TEST(LinearReadout, AllFormsOfATableAgree) {
  const WeightTable diagonal = WeightTable::dense(3, 3, {2.5, 0, 0, 0, 2.5, 0, 0, 0, 2.5});
  const WeightTable full = WeightTable::dense(3, 3, std::vector<double>(9, 0.25));
  const WeightTable mixed = random_weights(3, 3, 6);
  const std::vector<std::vector<WeightTable>> equal = {
      {diagonal, diagonal.compressed(), WeightTable::one_to_one(2.5)},
      {full, full.compressed(), WeightTable::uniform(0.25)},
      {mixed, mixed.compressed()}};
  for (const auto& forms : equal) {
    std::vector<std::vector<double>> results;
    for (const WeightTable& form : forms) {
      NodeHarness node("linear_readout", {3, 3}, {.weights = form});
      std::mt19937_64 generator(1);
      for (int i = 0; i < 100; ++i) {
        node.add_spike(node.time() + 1 + static_cast<TimeNs>(generator() % kMs),
                       static_cast<std::int32_t>(generator() % 3));
        node.step(kMs);
      }
      results.push_back(node.output());
    }
    for (const auto& result : results) {
      EXPECT_EQ(result, results[0]) << "bit by bit";
    }
  }
}

TEST(LinearReadout, LongSilenceDecaysExactlyAndThenRests) {
  NodeHarness node("linear_readout", {1, 1}, {.weights = WeightTable::one_to_one()});
  node.step(kMs);
  EXPECT_EQ(node.revision(), 1U) << "valid from the first tick";
  EXPECT_EQ(node.output()[0], 0.0);
  node.run_until(10 * kMs, kMs);
  EXPECT_EQ(node.revision(), 1U) << "0 is no news";
  node.add_spike(10 * kMs + 1, 0);
  node.step(kMs);
  EXPECT_EQ(node.revision(), 2U);
  for (const int seconds : {1, 3, 6, 15}) {
    node.run_until(seconds * kNsPerSecond, kMs);
    const double age = to_seconds(node.time() - (10 * kMs + 1));
    const double expected = std::exp(-age / 0.03) / 0.03;
    EXPECT_NEAR(node.output()[0] / expected, 1.0, 1e-12) << seconds;
    EXPECT_EQ(node.revision(), 2U + static_cast<std::uint64_t>(seconds) * 1000U - 11U)
        << "a new value every tick";
  }
  node.run_until(60 * kNsPerSecond, kMs);
  EXPECT_EQ(node.output()[0], 0.0);
  const std::uint64_t revision = node.revision();
  node.run_until(3600 * kNsPerSecond, 50 * kMs);
  EXPECT_EQ(node.revision(), revision);
  node.add_spike(node.time() + kMs, 0);
  node.step(kMs);
  EXPECT_DOUBLE_EQ(node.output()[0], 1.0 / 0.03) << "as good as new";
}

TEST(LinearReadout, Defect6MoreInputsThanOutputsAndForeignChannels) {
  NodeHarness node("linear_readout", {5, 2});
  for (std::int32_t c = 0; c < 5; ++c) {
    node.add_spike(kMs, c);
  }
  node.step(kMs);
  EXPECT_NEAR(node.output()[1], 1.0 / 0.03, 1e-12);
  for (const std::int32_t channel : {5, -1}) {
    NodeHarness strict("linear_readout", {5, 2});
    strict.add_spike(kMs, channel);
    EXPECT_THAT(
        message_of([&] { strict.step(kMs); }),
        Fault("a spike came on channel " + std::to_string(channel) + " ... 'in' ... 0 to 4 ..."));
  }
}

TEST(LinearReadout, TauIsChecked) {
  EXPECT_THAT(message_of([] {
                NodeHarness("linear_readout", {1, 1}, {.keys = {{"tau", "0 s"}}});
              }),
              Fault("test.yaml:7:3: key 'tau': 0 ... 1e-06 to 1000000 s ... [SL0203]"));
}

}  // namespace
}  // namespace spikeloop::testing
