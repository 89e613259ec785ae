// Encoders of values and of changes under random parameters, ticks and inputs: whatever comes, they
// end, stamp inside the interval (the harness checks), and neither lose nor double a spike.
#include <map>

#include "random_trial.hpp"

namespace spikeloop::testing::change_encoder_property_test {
namespace {

constexpr std::size_t kChannels = 3;

// Revises or invalidates the input now and then; `after(begin)` runs after every tick.
template <typename After>
void drive_randomly(RandomTrial& random, NodeHarness& node, HeldValues& held, After&& after) {
  for (int i = 0; i < 75; ++i) {
    if (random.chance(0.5)) {
      const std::vector<double> values = random.values(kChannels);
      node.set_input(values);
      held.take(values);
    } else if (random.chance(0.05)) {
      node.invalidate_input();
      held.clear();
    }
    const TimeNs begin = node.time();
    node.step(random.tick());
    after(begin);
  }
}

std::map<std::string, std::string> policy(bool zero) {
  return {{"not_finite", zero ? "zero" : "hold"}};
}

HeldValues nothing(bool zero) {
  return {std::vector<double>(kChannels, std::nan("")), zero};
}

TEST(EncoderProperty, PopulationEncoderNeitherLosesNorDoublesASpike) {
  run_trials(30, [](RandomTrial& random) {
    constexpr std::size_t kNeurons = 7;
    const bool zero = random.chance(0.5);
    const bool circular = random.chance(0.5);
    const double rate_min = random.pick<double>({0, 0, 3, 250});
    const double rate_max = random.pick<double>({100, 1e-12, 5000, 1e6});
    const double sigma = random.pick<double>({0.2, 1e-9, 1e9});
    auto keys = policy(zero);
    keys["circular"] = circular ? "true" : "false";
    keys["rate_min"] = fmt::format("{}", rate_min);
    keys["rate_max"] = fmt::format("{}", rate_max);
    keys["sigma"] = fmt::format("{}", sigma);
    NodeHarness node("population_encoder", {kChannels, kChannels * kNeurons}, {.keys = keys});
    HeldValues held = nothing(zero);
    std::vector<long double> integrals(kChannels * kNeurons, 0.0L);
    std::vector<long double> counts(kChannels * kNeurons, 0.0L);
    std::vector<TimeNs> last(kChannels * kNeurons, 0);
    drive_randomly(random, node, held, [&](TimeNs begin) {
      for (const Spike& spike : node.take_spikes()) {
        const auto c = static_cast<std::size_t>(spike.channel);
        ASSERT_GT(spike.time_ns, last[c]) << "two spikes at one time";
        last[c] = spike.time_ns;
        counts[c] += 1;
      }
      for (std::size_t c = 0; c < counts.size(); ++c) {
        const double x = held.values[c / kNeurons];
        const double i = static_cast<double>(c % kNeurons);
        double away = x - (-1 + 2 * i / (circular ? kNeurons : kNeurons - 1));
        away = circular ? std::remainder(away, 2) : away;
        const double rate =
            rate_min + (rate_max - rate_min) * std::exp(-std::pow(away / sigma, 2) / 2);
        const auto seconds = static_cast<long double>(node.time() - begin) * 1e-9L;
        integrals[c] += std::isnan(x) ? 0.0L : rate * seconds;
        ASSERT_NEAR(static_cast<double>(integrals[c] - counts[c] - 0.5L), 0, 0.51) << c;
      }
    });
  });
}

// Every spike is right for the value that was held at its time, and none is missing in the end.
TEST(EncoderProperty, StepForwardEncoderNeitherLosesNorDoublesASpike) {
  run_trials(40, [](RandomTrial& random) {
    const bool zero = random.chance(0.5);
    const double threshold = random.pick<double>({0.1, 0.25, 1.0, 1e9, 1e-9});
    const TimeNs interval = random.pick<TimeNs>({1'000, 12'345, kMs, 10 * kMs});
    auto keys = policy(zero);
    keys["threshold"] = fmt::format("{}", threshold);
    keys["min_interval"] = fmt::format("{} ns", interval);
    keys["initial_base"] = "0";
    NodeHarness node("step_forward_encoder", {kChannels, 2 * kChannels}, {.keys = keys});
    HeldValues held = nothing(zero);
    std::vector<double> steps(kChannels, 0.0);
    std::vector<TimeNs> last(kChannels, -kNsPerSecond);
    const auto check = [&](TimeNs) {
      for (const Spike& spike : node.take_spikes()) {
        const auto c = static_cast<std::size_t>(spike.channel / 2);
        const double direction = spike.channel % 2 == 0 ? 1 : -1;
        ASSERT_GE(spike.time_ns - last[c], interval);
        last[c] = spike.time_ns;
        steps[c] += direction;
        ASSERT_GE((held.values[c] - steps[c] * threshold) * direction, -1e-9) << "a step too far";
      }
    };
    drive_randomly(random, node, held, check);
    const std::vector<double> rest = {0.35, -0.2, 0.0};
    node.set_input(rest);
    held.take(rest);
    for (int i = 0; i < 20; ++i) {
      node.step(50 * kMs);
      check(0);
    }
    for (std::size_t c = 0; c < kChannels; ++c) {
      const double away = std::fabs(rest[c] - steps[c] * threshold);
      ASSERT_TRUE(away <= threshold * (1 + 1e-9) || last[c] > node.time() - interval) << "missing";
    }
  });
}

TEST(EncoderProperty, TemporalContrastEncoderNeitherLosesNorDoublesASpike) {
  run_trials(100, [](RandomTrial& random) {
    const bool zero = random.chance(0.5);
    const double threshold = random.pick<double>({0, 0.1, 1.0, 1e9});
    auto keys = policy(zero);
    keys["threshold"] = fmt::format("{}", threshold);
    NodeHarness node("temporal_contrast_encoder", {kChannels, 2 * kChannels}, {.keys = keys});
    HeldValues held = nothing(zero);
    std::vector<double> before = held.values;
    std::vector<Spike> expected;
    drive_randomly(random, node, held, [&](TimeNs begin) {
      for (std::size_t c = 0; c < kChannels; ++c) {
        const double difference = held.values[c] - before[c];
        if (std::fabs(difference) > threshold) {
          expected.push_back(make_spike(
              begin + 1'000, static_cast<std::int32_t>(2 * c) + (difference > 0 ? 0 : 1)));
        }
      }
      before = held.values;
    });
    node.step(kMs);
    const std::vector<Spike> seen = node.spikes();
    ASSERT_EQ(seen.size(), expected.size());
    std::sort(expected.begin(), expected.end(), spike_before);
    for (std::size_t i = 0; i < seen.size(); ++i) {
      ASSERT_EQ(seen[i].time_ns, expected[i].time_ns) << i;
      ASSERT_EQ(seen[i].channel, expected[i].channel) << i;
    }
  });
}

TEST(EncoderProperty, TimeToFirstSpikeEncoderNeitherLosesNorDoublesASpike) {
  run_trials(60, [](RandomTrial& random) {
    const bool zero = random.chance(0.5);
    const bool pass = random.chance(0.5);
    const TimeNs period = random.pick<TimeNs>({10'000, 777'777, 10 * kMs, 100 * kMs});
    const TimeNs t_max = random.chance(0.3) ? period : period / 2;
    auto keys = policy(zero);
    keys["out_of_range"] = pass ? "pass" : "clip";
    keys["period"] = fmt::format("{} ns", period);
    keys["t_min"] = "2 us";
    keys["t_max"] = fmt::format("{} ns", t_max);
    NodeHarness node("time_to_first_spike_encoder", {kChannels, kChannels}, {.keys = keys});
    std::vector<double> x(kChannels, std::nan(""));
    std::vector<Spike> expected;
    for (int i = 0; i < 75; ++i) {
      if (random.chance(0.5)) {
        const std::vector<double> values = random.values(kChannels);
        node.set_input(values);
        for (std::size_t c = 0; c < kChannels; ++c) {
          const double v = values[c];
          const bool none = std::isnan(v) || (pass && std::isinf(v));
          const double in_range = pass ? v : std::min(1.0, std::max(-1.0, v));
          x[c] = none ? (zero ? 0.0 : x[c]) : in_range;
        }
      }
      const TimeNs begin = node.time();
      node.step(random.tick());
      for (TimeNs start = (begin + period - 1) / period * period; start < node.time();
           start += period) {
        for (std::size_t c = 0; c < kChannels; ++c) {
          if (std::isnan(x[c])) {
            continue;
          }
          const long double exact =
              2000.0L + static_cast<long double>(t_max - 2000) * (1.0L - x[c]) / 2;
          const long double bounded =
              std::min(static_cast<long double>(period), std::max(1000.0L, exact));
          expected.push_back(make_spike(start + std::llround(bounded), static_cast<int>(c)));
        }
      }
    }
    std::erase_if(expected, [&](const Spike& spike) { return spike.time_ns > node.time(); });
    for (std::int32_t c = 0; c < static_cast<std::int32_t>(kChannels); ++c) {
      std::vector<TimeNs> times;
      for (const Spike& spike : expected) {
        if (spike.channel == c) times.push_back(spike.time_ns);
      }
      const std::vector<TimeNs> seen = node.times(c);
      // The last one may be due within rounding of the end.
      ASSERT_NEAR(static_cast<double>(seen.size()), static_cast<double>(times.size()), 1.0);
      for (std::size_t i = 0; i < std::min(seen.size(), times.size()); ++i) {
        ASSERT_LE(std::abs(seen[i] - times[i]), 1) << i;
      }
    }
  });
}

}  // namespace
}  // namespace spikeloop::testing::change_encoder_property_test
