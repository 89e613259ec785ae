// What samples are made of, against theory.
#include "spikeloop/fit/samples.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "spikeloop/core/error.hpp"
#include "spikeloop/core/registry.hpp"
#include "spikeloop/nodes/register.hpp"

namespace spikeloop::fit {
namespace {

constexpr TimeNs kMs = 1'000'000;

const Function kIdentity = [](std::span<const double> x, std::span<double> y) {
  std::copy(x.begin(), x.end(), y.begin());
};

/// NEF neurons that all have one tuning, upwards or downwards.
class Alike {
 public:
  Alike() {
    register_nodes(registry_);
    encoder_.node_class = &registry_.find("nef_encoder");
    encoder_.parameters = resolve(encoder_.node_class->description.parameters,
                                  {{"max_rate_low", {"300", {}}},
                                   {"max_rate_high", {"300", {}}},
                                   {"intercept_low", {"-0.5", {}}},
                                   {"intercept_high", {"-0.5", {}}},
                                   {"spike_times", {"interpolated", {}}}},
                                  {});
    encoder_.name = "cells";
    encoder_.neurons = 10;
  }
  Encoder& encoder() { return encoder_; }

  static double rate(double along) {
    const double full = 1 / (1 - std::exp((0.002 - 1.0 / 300) / 0.02));
    const double gain = (full - 1) / 1.5;
    const double drive = gain * along + 1 + 0.5 * gain;
    return drive <= 1 ? 0 : 1 / (0.002 + 0.02 * std::log(drive / (drive - 1)));
  }

 private:
  Registry registry_;
  Encoder encoder_;
};

TEST(SampleRates, AreThoseOfTheClosedForm) {
  Alike alike;
  int samples = 0;
  double sum = 0;
  sample_rates(alike.encoder(), 500, 0, kIdentity, 1, [&](const Sample& sample) {
    const double x = sample.input[0];
    EXPECT_LE(std::fabs(x), 1);
    EXPECT_EQ(sample.targets[0], x);
    for (const double rate : sample.activities) {
      const double up = Alike::rate(x);
      const double down = Alike::rate(-x);
      // Neurons below 2 Hz count as silent.
      EXPECT_TRUE(std::fabs(rate - up) < 1e-3 * up + (up < 4 ? 4 : 0) ||
                  std::fabs(rate - down) < 1e-3 * down + (down < 4 ? 4 : 0))
          << rate << " at " << x;
    }
    sum += x * x;
    ++samples;
  });
  EXPECT_EQ(samples, 500);
  EXPECT_NEAR(sum / samples, 1.0 / 3, 4 * std::sqrt(4.0 / 45 / 500)) << "uniform in [-1, 1]";
}

TEST(FilteredSpikes, AreTheKernelsSum) {
  FilteredSpikes filtered(2, 0.05);
  const std::vector<Spike> spikes{make_spike(3 * kMs / 2, 0), make_spike(7 * kMs, 1),
                                  make_spike(7 * kMs + 5, 0), make_spike(40 * kMs, 0)};
  std::size_t next = 0;
  for (TimeNs begin = 0; begin < 100 * kMs; begin += kMs) {
    std::vector<Spike> now;
    while (next < spikes.size() && spikes[next].time_ns <= begin + kMs) {
      now.push_back(spikes[next++]);
    }
    filtered.advance({begin, begin + kMs}, now);
    double expected[2] = {0, 0};
    for (const Spike& spike : spikes) {
      if (spike.time_ns <= begin + kMs) {
        expected[spike.channel] += std::exp(-to_seconds(begin + kMs - spike.time_ns) / 0.05) / 0.05;
      }
    }
    ASSERT_NEAR(filtered.activities()[0], expected[0], 1e-11);
    ASSERT_NEAR(filtered.activities()[1], expected[1], 1e-11);
  }
}

TEST(SampleSpikes, TargetsAreFilteredAndInputsStayWithinTheRadius) {
  Alike alike;
  alike.encoder().radius = 0.5;
  double last_s = 0;
  double squares = 0;
  int samples = 0;
  double mean = 0;
  sample_spikes(alike.encoder(), {.tau_s = 0.02, .duration_s = 30}, kIdentity, 1,
                [&](const Sample& sample) {
                  EXPECT_LE(std::fabs(sample.input[0]), 0.5 + 1e-12);
                  EXPECT_GT(sample.time_s, last_s);
                  last_s = sample.time_s;
                  squares += sample.input[0] * sample.input[0];
                  for (const double activity : sample.activities) {
                    mean += activity / 10;
                  }
                  ++samples;
                });
  EXPECT_EQ(samples, (30'000 - 100) / 5);
  EXPECT_NEAR(std::sqrt(squares / samples), 0.25, 0.04);
  EXPECT_GT(mean / samples, 20);
}

TEST(SampleRecording, RefusesATargetWithoutNumbers) {
  const std::vector<TimeNs> times{0, kMs};
  const std::vector<double> values{1.0, NAN};
  Recording recording{
      .spikes = {}, .neurons = 1, .times = times, .values = values, .width = 1, .end = 50 * kMs};
  const auto message = [&] {
    try {
      sample_recording(recording, {}, kIdentity, 1, [](const Sample&) {});
    } catch (const ConfigurationError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_EQ(message(),
            "the recorded target has the value nan at 0.001000 s; record a signal of "
            "finite numbers");
  recording.times = {};
  recording.values = {};
  EXPECT_EQ(message(), "the recorded target has no value; record a run in which it has one");
}

}  // namespace
}  // namespace spikeloop::fit
