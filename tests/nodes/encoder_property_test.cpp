// Random parameters, ticks and inputs, the worst ones included: whatever comes, an encoder ends,
// stamps inside the interval (the harness checks), and neither loses nor doubles a spike.
#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <random>

#include "harness.hpp"
#include "spikeloop/core/random.hpp"
#include "tests/support/repetitions.hpp"

namespace spikeloop::testing::encoder_property_test {
namespace {

constexpr std::uint32_t kChannels = 70;  // a whole block and a part of one

class Trial {
 public:
  Trial(unsigned seed, const std::string& node_class)
      : generator_(seed),
        node_class_(node_class),
        pass_(pick({0, 1}) == 1),
        zero_(pick({0, 1}) == 1),
        rate_min_(pick({0.0, 0.0, 3.0, 250.0})),
        rate_max_(pick({100.0, 1e-12, 5000.0, 1e6})),
        node_(node_class, {kChannels, kChannels},
              {.keys = {{"rate_min", fmt::format("{}", rate_min_)},
                        {"rate_max", fmt::format("{}", rate_max_)},
                        {"out_of_range", pass_ ? "pass" : "clip"},
                        {"not_finite", zero_ ? "zero" : "hold"}}}),
        rates_(kChannels, 0.0L),
        integrals_(kChannels, 0.0L),
        last_(kChannels, 0),
        counts_(kChannels, 0) {}

  void run() {
    for (int i = 0; i < 30; ++i) {
      if (uniform() < 0.7) {
        revise();
      } else if (uniform() < 0.1) {
        node_.invalidate_input();
        rates_.assign(kChannels, 0.0L);
      }
      const TimeNs tick = pick<TimeNs>({1, 7, 999, 123'457, kMs, 3 * kMs});
      node_.step(tick);
      for (std::size_t c = 0; c < kChannels; ++c) {
        integrals_[c] += rates_[c] * static_cast<long double>(tick) * 1e-9L;
      }
      check();
    }
  }

 private:
  template <typename T>
  T pick(std::vector<T> values) {
    return values[std::uniform_int_distribution<std::size_t>(0, values.size() - 1)(generator_)];
  }
  double pick(std::initializer_list<double> values) { return pick(std::vector<double>(values)); }
  double uniform() { return std::uniform_real_distribution<double>(0.0, 1.0)(generator_); }

  double random_value() {
    constexpr double kInf = std::numeric_limits<double>::infinity();
    if (uniform() < 0.6) {
      return 2 * uniform() - 1;
    }
    return pick({-1.0, 1.0, 0.0, -0.0, 1.2, -1.2, 1e300, -1e300, 5e-324, -5e-324, 1e-310, kInf,
                 -kInf, std::nan(""), std::nextafter(1.0, 2.0), std::nextafter(-1.0, -2.0),
                 std::nextafter(-1.0, 0.0), 1e6});
  }

  void revise() {
    std::vector<double> values(kChannels);
    for (std::size_t c = 0; c < kChannels; ++c) {
      values[c] = random_value();
      update_rate(c, values[c]);
    }
    node_.set_input(values);
  }

  // The policies as the documentation states them, once more.
  void update_rate(std::size_t c, double x) {
    if (std::isnan(x) || (pass_ && std::isinf(x))) {
      if (!zero_) {
        return;
      }
      x = 0.0;
    }
    if (!pass_) {
      x = std::min(1.0, std::max(-1.0, x));
    }
    const long double span = static_cast<long double>(rate_max_) - rate_min_;
    rates_[c] = std::min(1e6L, std::max(0.0L, rate_min_ + (x + 1.0L) / 2 * span));
  }

  // The integral that channel c must have reached at its last spike, and will have at the next.
  std::pair<long double, long double> thresholds(std::size_t c, std::size_t count) {
    if (node_class_ == "rate_encoder") {
      return {count, count + 1};
    }
    const RandomStream stream(1, "node");
    auto& sums = sums_[c];
    while (sums.size() <= count) {
      const long double last = sums.empty() ? 0.0L : sums.back();
      sums.push_back(last + stream.exponential(c, sums.size()));
    }
    return {count == 0 ? 0.0L : sums[count - 1], sums[count]};
  }

  void check() {
    for (const Spike& spike : node_.take_spikes()) {
      const auto c = static_cast<std::size_t>(spike.channel);
      ASSERT_GT(spike.time_ns, last_[c]) << "two spikes of channel " << c << " at one time";
      last_[c] = spike.time_ns;
      ++counts_[c];
    }
    for (std::size_t c = 0; c < kChannels; ++c) {
      const auto [reached, ahead] = thresholds(c, counts_[c]);
      // Stamps are whole ns: at 1 MHz, 0.001 of the integral each. A Poisson process can have a few
      // draws below that in a row.
      const long double slack = node_class_ == "rate_encoder" ? 0.0021L : 0.01L;
      ASSERT_GE(integrals_[c], reached - slack) << "a spike too many on channel " << c;
      ASSERT_LE(integrals_[c], ahead + slack) << "a spike is missing on channel " << c;
    }
  }

  std::mt19937_64 generator_;
  std::string node_class_;
  bool pass_;
  bool zero_;
  double rate_min_;
  double rate_max_;
  NodeHarness node_;
  std::vector<long double> rates_;
  std::vector<long double> integrals_;
  std::vector<TimeNs> last_;
  std::vector<std::size_t> counts_;
  std::map<std::size_t, std::vector<long double>> sums_;  // of a Poisson channel's draws
};

TEST(EncoderProperty, RateEncoderNeitherLosesNorDoublesASpike) {
  for (int seed = 0; seed < test::repetitions(60) && !::testing::Test::HasFailure(); ++seed) {
    SCOPED_TRACE(seed);
    Trial(static_cast<unsigned>(seed), "rate_encoder").run();
  }
}

TEST(EncoderProperty, PoissonEncoderNeitherLosesNorDoublesASpike) {
  for (int seed = 0; seed < test::repetitions(60) && !::testing::Test::HasFailure(); ++seed) {
    SCOPED_TRACE(seed);
    Trial(static_cast<unsigned>(seed), "poisson_encoder").run();
  }
}

}  // namespace
}  // namespace spikeloop::testing::encoder_property_test
