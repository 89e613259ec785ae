// Membrane potentials against their closed forms. The potential is not a port, so the threshold is
// the probe: put just below the closed form's value at a grid point, the neuron fires there; put
// just above, it does not.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <cmath>
#include <limits>

#include "run_network.hpp"

namespace spikeloop::test {
namespace {

constexpr double kTolerance = 1e-11;  // of the potential

struct Psc {
  double tau_m;
  double tau_syn;
};

// Response of the membrane to one exponential current of 1 pA, t ms after its begin, in mV.
long double psp(long double t, long double tau_m, long double tau_syn, long double C_m) {
  if (t <= 0) {
    return 0;
  }
  if (tau_m == tau_syn) {
    return t / C_m * std::exp(-t / tau_m);
  }
  return tau_m * tau_syn / (C_m * (tau_m - tau_syn)) *
         (std::exp(-t / tau_m) - std::exp(-t / tau_syn));
}

std::string exp_network(const Psc& psc, double threshold, double weight) {
  return fmt::format(
      "resolution: 0.1 ms\n"
      "populations:\n"
      "  input: {{model: input, size: 1}}\n"
      "  cell: {{model: iaf_psc_exp, size: 1, parameters: {{tau_m: {}, tau_syn_ex: {}, "
      "tau_syn_in: {}, C_m: 200, E_L: -65, V_reset: -75, V_th: {:.17g}}}}}\n"
      "connections:\n"
      "  - {{from: input, to: cell, rule: one_to_one, weight: {:.17g} pA, delay: 1 ms}}\n"
      "output: [cell]\n",
      psc.tau_m, psc.tau_syn, psc.tau_syn, -65.0 + threshold, weight);
}

TimeNs first_spike(const std::string& network, const Spikes& input) {
  const Spikes spikes = run(parse(network), input, 60 * kMs);
  return spikes.empty() ? 0 : spikes.front().time_ns;
}

class ExponentialCurrent : public testing::TestWithParam<Psc> {};

TEST_P(ExponentialCurrent, MembraneFollowsTheClosedForm) {
  const Psc psc = GetParam();
  const TimeNs arrival = 6 * kMs;  // spike at 5 ms, delay 1 ms
  for (int k = 1; k <= 12; ++k) {
    const double value = static_cast<double>(psp(0.1L * k, psc.tau_m, psc.tau_syn, 200) * 900);
    const TimeNs at = arrival + k * 100'000;
    // Threshold and resting potential are subtracted as doubles near 65 mV: their rounding, 1e-14,
    // is far below the tolerance.
    const double margin = kTolerance * value + 1e-13;
    EXPECT_EQ(first_spike(exp_network(psc, value - margin, 900), {make_spike(5 * kMs, 0)}), at);
    EXPECT_GT(first_spike(exp_network(psc, value + margin, 900), {make_spike(5 * kMs, 0)}), at);
  }
}

TEST_P(ExponentialCurrent, DecaysAndAddsUpLinearly) {
  // Excitation, then inhibition, then a stronger excitation that is probed on its rise.
  const Psc psc = GetParam();
  const auto network = [&](double threshold) {
    return fmt::format(
        "populations:\n"
        "  input: {{model: input, size: 3}}\n"
        "  cell: {{model: iaf_psc_exp, size: 1, parameters: {{tau_m: {}, tau_syn_ex: {}, "
        "tau_syn_in: 3.5, C_m: 200, E_L: -65, V_reset: -75, V_th: {:.17g}}}}}\n"
        "connections:\n"
        "  - {{from: input, to: cell, rule: pairs, pairs: [[0, 0, 1], [1, 0, -2.5], [2, 0, 200]], "
        "weight: 100 pA, delay: 0.7 ms}}\n"
        "output: [cell]\n",
        psc.tau_m, psc.tau_syn, -65.0 + threshold);
  };
  const Spikes input = {make_spike(ms(1.0), 0), make_spike(ms(6.2), 1), make_spike(ms(14.0), 2)};
  for (int k = 1; k <= 5; ++k) {
    const long double t = 14.7L + 0.1L * k;
    const auto value = static_cast<double>(100 * psp(t - 1.7L, psc.tau_m, psc.tau_syn, 200) -
                                           250 * psp(t - 6.9L, psc.tau_m, 3.5L, 200) +
                                           20000 * psp(t - 14.7L, psc.tau_m, psc.tau_syn, 200));
    const TimeNs at = ms(14.7) + k * 100'000;
    ASSERT_GT(value, 2.0) << "the probe must be above what the first spike alone reached";
    const double margin = kTolerance * 10;
    EXPECT_EQ(first_spike(network(value - margin), input), at);
    EXPECT_NE(first_spike(network(value + margin), input), at);
  }
}

INSTANTIATE_TEST_SUITE_P(TimeConstants, ExponentialCurrent,
                         testing::Values(Psc{10, 2}, Psc{10, 10}, Psc{5, 20}, Psc{20, 0.5}),
                         [](const auto& test) { return fmt::format("case{}", test.index); });

// Where tau_m and tau_syn differ by a hair the textbook form loses all digits. The limit is exact
// enough: its relative error is below |tau_m - tau_syn| / tau_m * t / tau_m.
TEST(ExponentialCurrentSingular, NearlyEqualTimeConstantsFollowTheLimit) {
  for (const double off : {1e-15, 1e-13, 1e-11}) {
    const Psc psc{10.0, 10.0 * (1 + off)};
    const double value = static_cast<double>(psp(1.0L, 10, 10, 200) * 900);
    const TimeNs at = 7 * kMs;
    EXPECT_EQ(first_spike(exp_network(psc, value * (1 - 1e-10), 900), {make_spike(5 * kMs, 0)}),
              at);
    EXPECT_GT(first_spike(exp_network(psc, value * (1 + 1e-10), 900), {make_spike(5 * kMs, 0)}),
              at);
  }
}

std::string delta_network(double threshold, double first, double second) {
  return fmt::format(
      "populations:\n"
      "  input: {{model: input, size: 2}}\n"
      "  cell: {{model: iaf_psc_delta, size: 1, parameters: {{tau_m: 12, V_th: {:.17g}}}}}\n"
      "connections:\n"
      "  - {{from: input, to: cell, rule: pairs, pairs: [[0, 0, {:.17g}], [1, 0, {:.17g}]], "
      "weight: 1 mV, delay: 1.5 ms}}\n"
      "output: [cell]\n",
      -70.0 + threshold, first, second);
}

TEST(DeltaCurrent, JumpsAndDecaysExponentially) {
  const Spikes input = {make_spike(2 * kMs, 0), make_spike(ms(9.3), 1)};
  for (const double first : {6.0, -6.0}) {
    const double value = first * std::exp(-7.3 / 12.0) + 8.0;
    EXPECT_EQ(first_spike(delta_network(value - 1e-12, first, 8.0), input), ms(10.8));
    EXPECT_EQ(first_spike(delta_network(value + 1e-12, first, 8.0), input), 0);
  }
}

TEST(DeltaCurrent, FiresInTheStepInWhichTheSpikeActs) {
  // Spike at 2 ms, delay 1.5 ms: the potential jumps at 3.5 ms, and there the spike is stamped.
  EXPECT_EQ(first_spike(delta_network(5, 5.5, 0), {make_spike(2 * kMs, 0)}), ms(3.5));
}

TEST(DeltaCurrent, LowerBoundHolds) {
  const auto network = [](double threshold) {
    return fmt::format(
        "populations:\n"
        "  input: {{model: input, size: 2}}\n"
        "  cell: {{model: iaf_psc_delta, size: 1, parameters: {{V_min: -73 mV, V_th: {:.17g}}}}}\n"
        "connections:\n"
        "  - {{from: input, to: cell, rule: pairs, pairs: [[0, 0, -50], [1, 0, 9]], weight: 1, "
        "delay: 1}}\n"
        "output: [cell]\n",
        -70.0 + threshold);
  };
  const Spikes input = {make_spike(1 * kMs, 0), make_spike(5 * kMs, 1)};
  const double value = -3.0 * std::exp(-0.4) + 9.0;
  EXPECT_EQ(first_spike(network(value - 1e-12), input), 6 * kMs);
  EXPECT_EQ(first_spike(network(value + 1e-12), input), 0);
}

struct Drive {
  const char* model;
  double I_e;
  double V_reset;
  double t_ref;
  double resolution;
};

class ConstantCurrent : public testing::TestWithParam<Drive> {};

TEST_P(ConstantCurrent, FiresWithTheClosedFormsPeriodOnTheGrid) {
  const Drive d = GetParam();
  const NetworkFile network = parse(fmt::format(
      "resolution: {} ms\n"
      "populations:\n"
      "  cell: {{model: {}, size: 1, parameters: {{I_e: {} pA, V_reset: {} mV, t_ref: {} ms}}}}\n"
      "output: [cell]\n",
      d.resolution, d.model, d.I_e, d.V_reset, d.t_ref));
  const Spikes spikes = run(network, {}, 400 * kMs, 2 * kMs);
  // V(t) - E_L = drive + (V_0 - drive) exp(-t / tau_m), threshold at 15 mV.
  const double drive = d.I_e * 10.0 / 250.0;
  const auto steps_to_threshold = [&](double start) {
    return std::ceil(10.0 * std::log((drive - start) / (drive - 15.0)) / d.resolution);
  };
  const double refractory = std::ceil(d.t_ref / d.resolution - 1e-9);
  const TimeNs h = ms(d.resolution);
  const TimeNs first = std::llround(steps_to_threshold(0.0)) * h;
  const TimeNs period = std::llround(steps_to_threshold(d.V_reset + 70.0) + refractory) * h;
  std::vector<std::pair<TimeNs, int>> wanted;
  for (TimeNs time = first; time <= 400 * kMs; time += period) {
    wanted.emplace_back(time, 0);
  }
  ASSERT_GT(wanted.size(), 5u);
  EXPECT_EQ(plain(spikes), wanted);
}

INSTANTIATE_TEST_SUITE_P(Drives, ConstantCurrent,
                         testing::Values(Drive{"iaf_psc_exp", 376, -70, 2, 0.1},
                                         Drive{"iaf_psc_exp", 500, -70, 2, 0.1},
                                         Drive{"iaf_psc_exp", 1000, -62, 0, 0.1},
                                         Drive{"iaf_psc_exp", 700, -80, 2.05, 0.1},
                                         Drive{"iaf_psc_delta", 376, -70, 2, 0.1},
                                         Drive{"iaf_psc_delta", 800, -75, 1.01, 0.02},
                                         Drive{"iaf_psc_delta", 600, -70, 3, 1}),
                         [](const auto& test) { return fmt::format("case{}", test.index); });

TEST(ConstantCurrentBelowThreshold, IsSilent) {
  for (const char* model : {"iaf_psc_exp", "iaf_psc_delta"}) {
    const NetworkFile network =
        parse(fmt::format("populations:\n  cell: {{model: {}, size: 1, parameters: {{I_e: "
                          "374.9}}}}\noutput: [cell]\n",
                          model));
    EXPECT_TRUE(run(network, {}, 500 * kMs, 10 * kMs).empty());
  }
}

TEST(InitialPotential, StartsWhereItIsWritten) {
  // From -60 mV with 15 mV/decay: V(t) = 10 exp(-t / 10 ms) + 20 (1 - exp(-t / 10 ms)).
  const NetworkFile network = parse(
      "populations:\n"
      "  cell: {model: iaf_psc_exp, size: 1, parameters: {V_m: -60 mV, I_e: 500}}\n"
      "output: [cell]\n");
  const double time = 10.0 * std::log((20.0 - 10.0) / (20.0 - 15.0));
  const Spikes spikes = run(network, {}, 20 * kMs);
  ASSERT_FALSE(spikes.empty());
  EXPECT_EQ(spikes.front().time_ns, std::llround(std::ceil(time / 0.1)) * 100'000);
}

}  // namespace
}  // namespace spikeloop::test
