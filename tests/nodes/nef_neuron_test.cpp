// One neuron of a NEF encoder against theory, and all of them on every instruction set.
#include <algorithm>
#include <cmath>
#include <string>

#include "sampled_signal.hpp"
#include "statistics.hpp"
#include "vector_targets.hpp"

namespace spikeloop::testing::nef_neuron_test {
namespace {

constexpr double kTau = 0.02;  // s
constexpr double kRefractory = 0.002;

using Keys = std::map<std::string, std::string>;

/// Neurons of Nengo's convention that are all alike.
Keys alike(double max_rate, double intercept, const Keys& more = {}) {
  Keys keys{{"max_rate_low", std::to_string(max_rate)},
            {"max_rate_high", std::to_string(max_rate)},
            {"intercept_low", std::to_string(intercept)},
            {"intercept_high", std::to_string(intercept)},
            {"one_hot", "true"}};
  keys.insert(more.begin(), more.end());
  return keys;
}

NodeHarness population(std::uint32_t dimensions, std::uint32_t neurons, Keys keys) {
  return {"nef_encoder", {dimensions, neurons}, {.keys = std::move(keys)}};
}

/// The drive in thresholds: Nengo's gain and bias from their definition.
double drive_at(double x, double max_rate, double intercept) {
  const double full = 1 / (1 - std::exp((kRefractory - 1 / max_rate) / kTau));
  const double gain = (1 - full) / (intercept - 1);
  return gain * x + 1 - gain * intercept;
}

double rising_time(double drive) {
  return kTau * std::log(drive / (drive - 1));
}

TEST(NefNeuron, InterpolatedRatesAreThoseOfTheClosedForm) {
  for (const double intercept : {-0.9, 0.0, 0.5}) {
    // Near the intercept the single precision of gain and bias decides when it fires.
    for (double x = -0.98; x <= 1; x += 0.05) {
      NodeHarness node = population(1, 1, alike(300, intercept, {{"spike_times", "interpolated"}}));
      node.set_input({x});
      node.run_until(20 * kNsPerSecond, 50 * kMs);
      const auto times = node.times();
      const double drive = drive_at(x, 300, intercept);
      if (drive <= 1) {
        EXPECT_TRUE(times.empty()) << x;
        continue;
      }
      if (times.size() < 2) {
        EXPECT_GT(rising_time(drive), 10) << x;
        continue;
      }
      const double rate =
          static_cast<double>(times.size() - 1) / to_seconds(times.back() - times[0]);
      EXPECT_NEAR(rate * (kRefractory + rising_time(drive)), 1, 1e-6) << x;
    }
  }
}

TEST(NefNeuron, FiresAtItsMaximumRateAtTheRadius) {
  NodeHarness node = population(
      1, 1,
      alike(250, 0.3,
            {{"spike_times", "interpolated"}, {"radius", "2"}, {"out_of_range", "pass"}}));
  node.set_input({2.0});
  node.run_until(10 * kNsPerSecond, 10 * kMs);
  EXPECT_NEAR(static_cast<double>(node.spike_count()), 2500, 1);
  node.set_input({0.599});
  node.take_spikes();
  node.run_until(20 * kNsPerSecond, 10 * kMs);
  EXPECT_EQ(node.spike_count(), 0U) << "below the intercept, times the radius";
}

TEST(NefNeuron, GridIntervalsAreRoundedUpToTheGrid) {
  for (const double resolution : {1e-3, 1e-4, 5e-4, 2e-3}) {
    for (double x = -0.2; x <= 1; x += 0.01) {
      NodeHarness node =
          population(1, 1, alike(400, -0.25, {{"resolution", std::to_string(resolution)}}));
      node.set_input({x});
      node.run_until(2 * kNsPerSecond, 50 * kMs);
      const auto times = node.times();
      const TimeNs grid = from_seconds(resolution);
      const double rising = rising_time(drive_at(x, 400, -0.25));
      const TimeNs interval =
          from_seconds(kRefractory) + static_cast<TimeNs>(std::ceil(rising / resolution)) * grid;
      ASSERT_GT(times.size(), 5U);
      EXPECT_EQ(times.front() % grid, 0);
      for (std::size_t k = 1; k < times.size(); ++k) {
        ASSERT_EQ(times[k] - times[k - 1], interval) << x << " " << resolution;
      }
    }
  }
}

/// An independent solution: from one point of the grid or change of the input to the next with the
/// exact exponential; between these the potential is monotonic.
std::vector<TimeNs> reference_on_grid(const SampledSignal& signal, TimeNs grid, double max_rate,
                                      double intercept, TimeNs first) {
  std::vector<TimeNs> spikes{first};
  double potential = 0;
  TimeNs free_at = first + from_seconds(kRefractory);
  TimeNs now = first;
  const TimeNs end = signal.period * static_cast<TimeNs>(signal.values.size());
  while (now < end) {
    const TimeNs change = (now / signal.period + 1) * signal.period;
    TimeNs next = std::min({(now / grid + 1) * grid, change, end});
    if (now < free_at) {
      now = std::min(next, free_at);
      continue;
    }
    const double target =
        drive_at(signal.values[static_cast<std::size_t>(now / signal.period)], max_rate, intercept);
    potential = target + (potential - target) * std::exp(-to_seconds(next - now) / kTau);
    potential = std::max(potential, 0.0);  // Nengo's min_voltage
    if (potential >= 1) {
      const TimeNs stamp = (next + grid - 1) / grid * grid;
      if (stamp <= end) {
        spikes.push_back(stamp);
      }
      potential = 0;
      free_at = stamp + from_seconds(kRefractory);
    }
    now = next;
  }
  return spikes;
}

TEST(NefNeuron, FollowsAChangingInputOnAGrid) {
  for (const TimeNs period : {7 * kMs, 3'300'000L, 700'001L, 50 * kMs}) {
    const SampledSignal signal = noise(600, period, static_cast<unsigned>(period % 97));
    NodeHarness node = population(1, 1, alike(350, -0.6));
    drive(node, signal, period);
    const auto times = node.times();
    ASSERT_GT(times.size(), 5U);
    EXPECT_EQ(times, reference_on_grid(signal, kMs, 350, -0.6, times[0])) << period;
  }
}

TEST(NefNeuron, ASpikeThatIsDueComesThoughTheInputEnds) {
  // The threshold is met between two points of the grid, and the input falls before the second.
  const double rising = rising_time(drive_at(1, 400, -0.25));
  NodeHarness node = population(1, 1, alike(400, -0.25));
  node.set_input({1.0});
  node.run_until(20 * kMs, kMs);
  const TimeNs last = node.times().back();
  const TimeNs crossing = last + from_seconds(kRefractory + rising);
  ASSERT_NE(crossing % kMs, 0);
  node.run_until(crossing + 1000, kMs / 10);
  const auto before = node.spike_count();
  node.set_input({-1.0});
  node.run_until(crossing + 300 * kMs, kMs / 10);
  EXPECT_EQ(node.spike_count(), before + 1);
  EXPECT_EQ(node.times().back(), (crossing / kMs + 1) * kMs);
}

TEST(NefNeuron, AnswersAtOnceAfterALongInhibition) {
  NodeHarness node = population(1, 1, alike(395, 0.85, {{"spike_times", "interpolated"}}));
  node.set_input({-1.0});
  node.run_until(200 * kMs, kMs);
  EXPECT_EQ(node.spike_count(), 0U);
  node.set_input({1.0});
  node.run_until(300 * kMs, kMs);
  // As Nengo's, its potential has not fallen below 0.
  const TimeNs wait = node.times().front() - 200 * kMs;
  EXPECT_NEAR(to_seconds(wait), rising_time(drive_at(1, 395, 0.85)), 2e-9);
}

TEST(NefNeuron, SlowNeuronsKeepTheirPrecision) {
  // At 20 Hz the drive at the radius is 4e-11 thresholds above the threshold.
  for (const double rate : {20.0, 40.0}) {
    NodeHarness node =
        population(1, 1, alike(rate, 0.5, {{"spike_times", "interpolated"}, {"tau_m", "0.002"}}));
    node.set_input({1.0});
    node.run_until(2 * kNsPerSecond, 10 * kMs);
    const auto times = node.times();
    if (times.size() < 3) {  // its direction is down
      node.set_input({-1.0});
      node.run_until(4 * kNsPerSecond, 10 * kMs);
    }
    const auto found = node.times();
    ASSERT_GT(found.size(), 3U) << rate;
    EXPECT_NEAR(to_seconds(found[3] - found[2]) * rate, 1, 1e-4);
    node.take_spikes();
    node.set_input({0.0});
    node.run_until(8 * kNsPerSecond, 10 * kMs);
    EXPECT_LE(node.spike_count(), 1U) << "below the intercept";
  }
}

TEST(NefPopulationOnEveryTarget, GivesTheSameSpikesToTheBit) {
  const SampledSignal signal = noise(40, 13 * kMs);
  const VectorTarget best = vector_target();
  for (const std::string times : {"grid", "interpolated"}) {
    std::vector<Spike> reference;
    for (const auto target : {VectorTarget::baseline, VectorTarget::avx2, VectorTarget::avx3}) {
      if (!choose_vector_target(target)) {
        continue;
      }
      NodeHarness node = population(3, 203, {{"spike_times", times}});
      drive(node, signal, kMs, false, 3);
      const auto spikes = node.spikes();
      EXPECT_GT(spikes.size(), 5000U);
      if (reference.empty()) {
        reference = spikes;
      }
      EXPECT_TRUE(std::ranges::equal(spikes, reference,
                                     [](const Spike& a, const Spike& b) {
                                       return a.time_ns == b.time_ns && a.channel == b.channel;
                                     }))
          << times << " on target " << static_cast<int>(target);
    }
  }
  choose_vector_target(best);
}

TEST(NefEncoderKeys, SaysWhatIsWrong) {
  const auto error = [](const Keys& keys) { return message_of([&] { population(1, 1, keys); }); };
  EXPECT_EQ(error({{"gain_min", "5"}}),
            "test.yaml:7:3: key 'gain_min' is of the presets rma and ma; write preset=rma, or "
            "max_rate_low, max_rate_high, intercept_low and intercept_high [SL0208]");
  EXPECT_EQ(error({{"preset", "ma"}, {"radius", "2"}}),
            "test.yaml:7:3: key 'radius' is of the preset nengo; write preset=nengo, or gain_min, "
            "gain_max, bias_min and bias_max [SL0208]");
  EXPECT_EQ(
      error({{"max_rate_low", "500"}}),
      "test.yaml:7:3: key 'max_rate_low': 500 is above max_rate_high, 400; write max_rate_low "
      "at most max_rate_high [SL0206]");
  EXPECT_EQ(error({{"intercept_high", "-2"}}),
            "test.yaml:7:3: key 'intercept_low': -1 is above intercept_high, -2; write "
            "intercept_low at most intercept_high [SL0206]");
  EXPECT_EQ(error({{"max_rate_high", "500"}}),
            "test.yaml:7:3: key 'max_rate_high': 500 Hz leaves no time between refractory periods "
            "of 0.002 s; write less than 499.75 Hz [SL0203]");
  EXPECT_EQ(
      error({{"max_rate_low", "1"}}),
      "test.yaml:7:3: key 'max_rate_low': 1 Hz are too slow for a membrane of 0.02 s; write at "
      "least 2.01 Hz, or a longer tau_m [SL0203]");
  EXPECT_THAT(error({{"t_ref", "0.0015"}}), Fault("test.yaml:7:3: key 't_ref': 1.5 ms ... 1 ms ... "
                                                  "or spike_times=interpolated ... [SL0207]"));
  EXPECT_THAT(error({{"resolution", "0.0015"}}),
              Fault("test.yaml:7:3: key 't_ref': 2 ms ... 1.5 ms ... or spike_times=interpolated "
                    "... [SL0207]"));
}

TEST(NefEncoderKeys, PresetsHaveTheOlderProgramsConstants) {
  // In one dimension ma's neurons get 100 pA e x + 275 to 475 pA, with tau 10 ms, 250 pF and 15 mV.
  NodeHarness node = population(1, 2000, {{"preset", "ma"}, {"spike_times", "interpolated"}});
  node.set_input({0.0});
  node.run_until(kNsPerSecond, 10 * kMs);
  std::vector<std::vector<TimeNs>> times(2000);
  for (const Spike& spike : node.spikes()) {
    times[static_cast<std::size_t>(spike.channel)].push_back(spike.time_ns);
  }
  std::vector<double> biases;
  std::size_t silent = 0;
  for (const auto& of_one : times) {
    if (of_one.size() < 3) {
      ++silent;
      continue;
    }
    const double rising = to_seconds(of_one[2] - of_one[1]) - kRefractory;
    biases.push_back(15 / (1 - std::exp(-rising / 0.01)) / (10.0 / 250));
  }
  // Those below 15 mV / (10 ms / 250 pF) = 375 pA are silent: one in two.
  EXPECT_NEAR(static_cast<double>(silent), 1000, 4 * std::sqrt(500.0));
  EXPECT_LT(kolmogorov_smirnov(biases, [](double x) { return (x - 375) / 100; }),
            1.95 / std::sqrt(static_cast<double>(biases.size())));
}

}  // namespace
}  // namespace spikeloop::testing::nef_neuron_test
