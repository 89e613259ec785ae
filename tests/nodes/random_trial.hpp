// Random choices, the worst ones included, for tests that hold for whatever comes.
#pragma once

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "harness.hpp"
#include "tests/support/repetitions.hpp"

namespace spikeloop::testing {

class RandomTrial {
 public:
  explicit RandomTrial(unsigned seed) : generator_(seed) {}

  template <typename T>
  T pick(const std::vector<T>& values) {
    return values[std::uniform_int_distribution<std::size_t>(0, values.size() - 1)(generator_)];
  }
  std::string word(const std::vector<std::string>& words) { return pick(words); }
  double uniform() { return std::uniform_real_distribution<double>(0.0, 1.0)(generator_); }
  bool chance(double probability) { return uniform() < probability; }

  double value() {
    constexpr double kInf = std::numeric_limits<double>::infinity();
    if (chance(0.6)) {
      return 2 * uniform() - 1;
    }
    return pick<double>({-1.0, 1.0, 0.0, -0.0, 1.2, -1.2, 1e300, -1e300, 1.7e308, -1.7e308, 5e-324,
                         -5e-324, 1e-310, kInf, -kInf, std::nan(""), std::nextafter(1.0, 2.0),
                         std::nextafter(-1.0, 0.0), 1e6});
  }
  std::vector<double> values(std::size_t count) {
    std::vector<double> values(count);
    for (double& each : values) {
      each = value();
    }
    return values;
  }
  TimeNs tick() { return pick<TimeNs>({1, 7, 999, 1'000, 1'001, 123'457, kMs, 3 * kMs, 50 * kMs}); }

  /// A spike of the coming interval, or a late one.
  Spike spike(TimeNs begin, TimeNs tick, std::int32_t channels) {
    const TimeNs earliest = chance(0.8) ? begin + 1 : std::max<TimeNs>(1, begin - 200 * kMs);
    return make_spike(std::uniform_int_distribution<TimeNs>(earliest, begin + tick)(generator_),
                      std::uniform_int_distribution<std::int32_t>(0, channels - 1)(generator_));
  }

 private:
  std::mt19937_64 generator_;
};

/// What a node with the policies `hold` and `zero` makes of its inputs, once more: the held value
/// of every channel; NaN while it has none.
struct HeldValues {
  std::vector<double> values;
  bool zero = false;

  void take(const std::vector<double>& in) {
    for (std::size_t c = 0; c < in.size(); ++c) {
      values[c] = std::isfinite(in[c]) ? in[c] : zero ? 0.0 : values[c];
    }
  }
  void clear() { values.assign(values.size(), std::nan("")); }
};

inline void expect_finite(const NodeHarness& node) {
  if (node.revision() == 0) {
    return;
  }
  for (const double value : node.output()) {
    ASSERT_TRUE(std::isfinite(value)) << value << " at " << node.time();
  }
}

template <typename Trial>
void run_trials(int count, Trial&& trial) {
  for (int seed = 0; seed < test::repetitions(count) && !::testing::Test::HasFailure(); ++seed) {
    SCOPED_TRACE(seed);
    RandomTrial random(static_cast<unsigned>(seed));
    trial(random);
  }
}

}  // namespace spikeloop::testing
