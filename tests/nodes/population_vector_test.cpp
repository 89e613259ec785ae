// The weighted mean against sums over all spikes, and against what an encoder was given.
#include <cmath>
#include <complex>
#include <numbers>

#include "spike_trains.hpp"

namespace spikeloop::testing {
namespace {

using Keys = std::map<std::string, std::string>;

// The filtered rate of every neuron, from all spikes at once.
std::vector<long double> rates_at(const std::vector<Spike>& spikes, std::size_t neurons, double tau,
                                  TimeNs now) {
  std::vector<long double> rates(neurons, 0.0L);
  for (const Spike& spike : spikes) {
    if (spike.time_ns <= now) {
      rates[static_cast<std::size_t>(spike.channel)] +=
          std::exp(-static_cast<long double>(now - spike.time_ns) * 1e-9L / tau);
    }
  }
  return rates;
}

TEST(PopulationVector, EvenIsTheMeanOfEvenlySpacedValues) {
  const auto spikes = random_spikes(2000, 12, kNsPerSecond);
  NodeHarness node("population_vector", {12, 3},
                   {.keys = {{"value_min", "2"}, {"value_max", "8"}, {"tau", "20 ms"}}});
  play(node, spikes, kNsPerSecond, 10 * kMs, [&] {
    if (node.revision() == 0) {
      return;
    }
    const auto rates = rates_at(spikes, 12, 0.02, node.time());
    for (std::size_t k = 0; k < 3; ++k) {
      long double product = 0;
      long double sum = 0;
      for (std::size_t i = 0; i < 4; ++i) {
        product += rates[4 * k + i] * (2 + 2 * static_cast<long double>(i));
        sum += rates[4 * k + i];
      }
      ASSERT_NEAR(node.output()[k], static_cast<double>(product / sum), 1e-12) << node.time();
    }
  });
  EXPECT_GT(node.revision(), 90U);
  EXPECT_EQ(node.counter("spikes"), 2000U);
  EXPECT_EQ(node.counter("late_spikes"), 0U);
}

TEST(PopulationVector, ATableSaysWhatEachNeuronPrefers) {
  const auto spikes = random_spikes(1000, 5, kNsPerSecond);
  const WeightTable table = WeightTable::dense(2, 5, {0.5, 0, -3, 7, 1, 0, 2, 0, -1, 1e6});
  for (const WeightTable& form : {table, table.compressed()}) {
    NodeHarness node("population_vector", {5, 2}, {.weights = form, .weights_key = "directions"});
    play(node, spikes, kNsPerSecond, 50 * kMs, [&] {
      const auto rates = rates_at(spikes, 5, 0.03, node.time());
      for (std::uint32_t k = 0; k < 2; ++k) {
        long double product = 0;
        long double sum = 0;
        for (std::uint32_t i = 0; i < 5; ++i) {
          product += rates[i] * table.at(k, i);
          sum += rates[i];
        }
        ASSERT_NEAR(node.output()[k] / (k == 0 ? 1 : 1e6),
                    static_cast<double>(product / sum) / (k == 0 ? 1 : 1e6), 1e-12);
      }
    });
  }
}

TEST(PopulationVector, OneToOneIsEachNeuronsShare) {
  NodeHarness node("population_vector", {3, 3},
                   {.weights = WeightTable::one_to_one(), .weights_key = "directions"});
  for (const std::int32_t channel : {0, 0, 1, 2}) {
    node.add_spike(kMs, channel);
  }
  node.step(kMs);
  EXPECT_EQ(node.output(), (std::vector<double>{0.5, 0.25, 0.25}));
}

TEST(PopulationVector, CircularIsTheAngleOfTheSumOfVectors) {
  const auto spikes = random_spikes(3000, 7, kNsPerSecond);
  NodeHarness node("population_vector", {7, 1},
                   {.keys = {{"circular", "true"}, {"value_min", "-180"}, {"value_max", "180"}}});
  play(node, spikes, kNsPerSecond, 10 * kMs, [&] {
    const auto rates = rates_at(spikes, 7, 0.03, node.time());
    std::complex<long double> sum = 0;
    for (std::size_t i = 0; i < 7; ++i) {
      sum += std::polar(rates[i], (-180 + 360 * static_cast<long double>(i) / 7) / 180 *
                                      std::numbers::pi_v<long double>);
    }
    const long double angle = std::arg(sum) * 180 / std::numbers::pi_v<long double>;
    const double away = std::remainder(node.output()[0] - static_cast<double>(angle), 360);
    ASSERT_NEAR(away, 0, 1e-9) << node.time();
    ASSERT_GE(node.output()[0], -180);
    ASSERT_LT(node.output()[0], 180);
  });
}

TEST(PopulationVector, OppositeAnglesAreNoDirection) {
  NodeHarness node("population_vector", {4, 1}, {.keys = {{"circular", "true"}}});
  const auto fire = [&](std::vector<std::int32_t> channels) {
    for (const std::int32_t channel : channels) node.add_spike(node.time() + kMs, channel);
    node.step(kMs);
  };
  fire({0, 2});
  EXPECT_EQ(node.revision(), 0U) << "no value yet";
  fire({1});
  EXPECT_NEAR(node.output()[0], -0.5, 1e-12);
  NodeHarness other("population_vector", {4, 1}, {.keys = {{"circular", "true"}}});
  other.add_spike(kMs, 3);
  other.step(kMs);
  other.add_spike(kMs, 1);  // late: at the time of the first, so that they cancel out
  other.step(kMs);
  EXPECT_NEAR(other.output()[0], 0.5, 1e-12) << "held";
  EXPECT_EQ(other.revision(), 1U);
}

TEST(PopulationVector, AnAngleJustBelowTheMaximumIsTheMinimum) {
  NodeHarness node("population_vector", {8, 1}, {.keys = {{"circular", "true"}}});
  node.add_spike(kMs, 1);
  node.add_spike(kMs, 7);  // the mean of the two is the minimum, but for rounding
  node.step(kMs);
  EXPECT_NEAR(node.output()[0], -1, 1e-12);
}

TEST(PopulationVector, DecodesWhatThePopulationEncoderEncodes) {
  for (const char* circular : {"false", "true"}) {
    NodeHarness encoder("population_encoder", {3, 60},
                        {.keys = {{"circular", circular}, {"rate_max", "500"}}});
    NodeHarness decoder("population_vector", {60, 3},
                        {.keys = {{"circular", circular}, {"tau", "0.5"}}});
    const std::vector<double> x = {0.31, -0.62, 0.05};
    encoder.set_input(x);
    while (encoder.time() < 5 * kNsPerSecond) {
      encoder.step(10 * kMs);
      for (const Spike& spike : encoder.take_spikes()) {
        decoder.add_spike(spike.time_ns, spike.channel);
      }
      decoder.step(10 * kMs);
    }
    for (std::size_t d = 0; d < 3; ++d) {
      EXPECT_NEAR(decoder.output()[d], x[d], 0.003) << circular;
    }
  }
}

TEST(PopulationVector, ValuesDoNotDependOnTheTick) {
  const auto spikes = random_spikes(3000, 12, 5 * kNsPerSecond);
  for (const char* circular : {"false", "true"}) {
    std::vector<std::vector<double>> reference;
    for (const TimeNs tick : {50 * kMs, 10 * kMs, kMs, kMs / 10}) {
      NodeHarness node("population_vector", {12, 2},
                       {.keys = {{"circular", circular}, {"tau", "1 ms"}}});
      const auto outputs = outputs_at(node, spikes, 5 * kNsPerSecond, tick, 50 * kMs);
      reference = reference.empty() ? outputs : reference;
      EXPECT_EQ(outputs, reference) << "bit by bit, tick " << tick;
    }
  }
}

TEST(PopulationVector, SilenceHoldsTheLastValue) {
  NodeHarness node("population_vector", {4, 2});
  node.run_until(100 * kMs, kMs);
  EXPECT_EQ(node.revision(), 0U) << "invalid before the first spike";
  node.add_spike(node.time() + kMs, 1);
  node.step(kMs);
  EXPECT_EQ(node.revision(), 0U) << "the other output has none yet";
  node.add_spike(node.time() + kMs, 2);
  node.step(kMs);
  EXPECT_EQ(node.output(), (std::vector<double>{1, -1}));
  EXPECT_EQ(node.revision(), 1U);
  node.run_until(100 * kNsPerSecond, 50 * kMs);
  EXPECT_EQ(node.output(), (std::vector<double>{1, -1}));
  for (int i = 0; i < 1000; ++i) {  // output 0 stays what it was, while output 1 goes on
    node.add_spike(node.time() + 1, i % 5 == 0 ? 3 : 2);
    node.step(10 * kMs);
    ASSERT_EQ(node.output()[0], 1);
    ASSERT_LE(std::fabs(node.output()[1]), 1);
  }
}

TEST(PopulationVector, LateSpikesCountWithTheirTrueAge) {
  NodeHarness node("population_vector", {2, 1});
  node.run_until(100 * kMs, kMs);
  node.add_spike(101 * kMs, 0);
  node.add_spike(41 * kMs, 1);  // 60 ms old
  node.step(kMs);
  const double weight = std::exp(-2.0);
  EXPECT_NEAR(node.output()[0], (weight - 1) / (weight + 1), 1e-14);
  EXPECT_EQ(node.counter("late_spikes"), 1U);
  NodeHarness ancient("population_vector", {2, 1}, {.keys = {{"tau", "1 ms"}}});
  ancient.run_until(10 * kNsPerSecond, 10 * kMs);
  ancient.add_spike(kMs, 0);  // nothing is left of its kernel
  ancient.add_spike(ancient.time() + kMs, 1);
  ancient.step(kMs);
  EXPECT_EQ(ancient.output()[0], 1);
  NodeHarness two("population_vector", {4, 2}, {.keys = {{"tau", "1 ms"}}});
  two.run_until(kNsPerSecond, kMs);
  two.add_spike(kNsPerSecond + kMs, 3);
  two.step(kMs);
  two.add_spike(kNsPerSecond - 299 * kMs, 0);  // exp(-300) is less than 1e-100
  two.step(kMs);
  EXPECT_EQ(two.revision(), 0U) << "output 0 has no value yet";
  two.add_spike(kNsPerSecond - 199 * kMs, 0);
  two.step(kMs);
  EXPECT_EQ(two.output(), (std::vector<double>{-1, 1}));
}

TEST(PopulationVector, WhatDoesNotFitIsRefused) {
  EXPECT_THAT(message_of([] {
                NodeHarness("population_vector", {7, 2});
              }),
              Fault("port 'in' has 7 ... 'out' 2; make 'in' ... 2 wide: ... [SL0306]"));
  const auto failure = [](const WeightTable& table, std::uint32_t in, std::uint32_t out) {
    return message_of([&] {
      NodeHarness("population_vector", {in, out}, {.weights = table, .weights_key = "directions"});
    });
  };
  EXPECT_THAT(
      failure(WeightTable::uniform(), 4, 2),
      Fault("test.yaml:8:3: key 'directions': in a uniform table all neurons prefer the same; "
            "write a table with a row an output and a column a neuron, or even [SL0308]"));
  EXPECT_THAT(failure(WeightTable::dense(2, 2, {1, 2, 3, 4}), 3, 2),
              Fault("test.yaml:8:3: key 'directions': ... 2 rows and 2 columns ... 2 outputs and 3 "
                    "inputs ... [SL0308]"));
  EXPECT_EQ(
      failure(WeightTable::dense(1, 2, {1, std::nan("")}), 2, 1),
      "test.yaml:8:3: key 'directions': weight 1 of 2 is not finite; write a number [SL0201]");
  EXPECT_THAT(failure(WeightTable::dense(1, 2, {1, -1e101}), 2, 1),
              Fault("test.yaml:8:3: key 'directions': -1e+101 ... write values from -1e+100 to "
                    "1e+100 ... [SL0203]"));
  EXPECT_EQ(message_of([] {
              NodeHarness("population_vector", {2, 1},
                          {.keys = {{"value_min", "3"}, {"value_max", "2"}}});
            }),
            "test.yaml:7:3: key 'value_min': 3 is not below value_max, 2; write value_min below "
            "value_max [SL0206]");
}

TEST(PopulationVector, SpikesOnForeignChannelsEndTheRun) {
  for (const std::int32_t channel : {2, -1}) {
    NodeHarness node("population_vector", {2, 1});
    node.add_spike(kMs, channel);
    EXPECT_EQ(message_of([&] { node.step(kMs); }),
              "a spike came on channel " + std::to_string(channel) +
                  ", but port 'in' has channels 0 to 1; make the connection wider or mend the "
                  "sender");
  }
}

}  // namespace
}  // namespace spikeloop::testing
