// Random populations, inputs and ticks, the worst ones included: whatever comes, a NEF encoder
// ends, stamps inside the interval (the harness checks), and gives the same spikes however the time
// is cut into ticks and however often an equal input is said to be new.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "harness.hpp"
#include "tests/support/repetitions.hpp"

namespace spikeloop::testing::nef_property_test {
namespace {

struct Segment {
  std::vector<double> input;  // empty: no value
  TimeNs length = 0;
};

class Trial {
 public:
  explicit Trial(unsigned seed) : generator_(seed) {
    dimensions_ = static_cast<std::uint32_t>(pick({1, 2, 5}));
    neurons_ = static_cast<std::uint32_t>(pick({1, 8, 13, 40}));
    grid_ = pick({0, 1, 100, 1000}) * 1000;
    t_ref_ = pick({0, 1'000'000, 2'000'000, 30'000'000});
    keys_ = {{"t_ref", fmt::format("{} ns", t_ref_)},
             {"tau_m", fmt::format("{}", pick({1e-4, 0.02, 3.0}))},
             {"spike_times", grid_ == 0 ? "interpolated" : "grid"},
             {"out_of_range", pick({0, 1}) == 0 ? "clip" : "pass"},
             {"not_finite", pick({0, 1}) == 0 ? "hold" : "zero"}};
    if (grid_ != 0) {
      keys_["resolution"] = fmt::format("{} ns", grid_);
    }
    if (pick({0, 1}) == 0 && keys_["tau_m"] != "0.0001") {  // which cannot fire so slowly
      keys_["max_rate_low"] = "3";
      keys_["max_rate_high"] = t_ref_ == 0 ? "100000" : "30";
      keys_["intercept_low"] = "-3";
    } else {
      keys_["preset"] = "rma";
      keys_["gain_min"] = "-1000";
      keys_["gain_max"] = fmt::format("{}", pick({1e3, 1e7}));
      keys_["bias_min"] = "-300";
      keys_["bias_max"] = "800";
    }
    for (int i = 0; i < 25; ++i) {
      segments_.push_back(random_segment());
    }
  }

  void run() {
    const auto whole = spikes(false);
    check(whole);
    const auto pieces = spikes(true);
    ASSERT_EQ(whole.size(), pieces.size());
    for (std::size_t i = 0; i < whole.size(); ++i) {
      ASSERT_EQ(whole[i].time_ns, pieces[i].time_ns) << i;
      ASSERT_EQ(whole[i].channel, pieces[i].channel) << i;
    }
  }

 private:
  template <typename T>
  T pick(std::initializer_list<T> values) {
    return *(values.begin() +
             std::uniform_int_distribution<std::ptrdiff_t>(0, std::ssize(values) - 1)(generator_));
  }
  double uniform() { return std::uniform_real_distribution<double>(0.0, 1.0)(generator_); }

  double random_value() {
    constexpr double kInf = std::numeric_limits<double>::infinity();
    if (uniform() < 0.85) {
      return 2 * uniform() - 1;
    }
    return pick({0.0, 1.0, -1.0, 5.0, -5e3, 1e300, 5e-324, kInf, -kInf, std::nan("")});
  }

  Segment random_segment() {
    Segment segment;
    if (uniform() > 0.1) {
      segment.input.resize(dimensions_);
      std::ranges::generate(segment.input, [&] { return random_value(); });
    }
    segment.length = pick<TimeNs>({1, 777, 123'457, 1'000'000, 2'500'000, 9'000'000});
    return segment;
  }

  std::vector<Spike> spikes(bool in_pieces) {
    NodeHarness node("nef_encoder", {dimensions_, neurons_}, {.keys = keys_});
    for (const Segment& segment : segments_) {
      const TimeNs end = node.time() + segment.length;
      do {
        segment.input.empty() ? node.invalidate_input() : node.set_input(segment.input);
        const TimeNs left = end - node.time();
        node.step(in_pieces && uniform() < 0.8 ? std::max<TimeNs>(1, left / 3) : left);
      } while (node.time() < end);
    }
    return node.spikes();
  }

  void check(const std::vector<Spike>& spikes) const {
    std::vector<TimeNs> last(neurons_, -1);
    for (const Spike& spike : spikes) {
      TimeNs& before = last[static_cast<std::size_t>(spike.channel)];
      if (before >= 0) {
        // Stamps are rounded to the nearest nanosecond each.
        ASSERT_GE(spike.time_ns - before, std::max<TimeNs>(t_ref_ - 1, 1));
      }
      if (grid_ != 0) {
        ASSERT_EQ(spike.time_ns % grid_, 0);
      }
      before = spike.time_ns;
    }
  }

  std::mt19937_64 generator_;
  std::uint32_t dimensions_ = 0;
  std::uint32_t neurons_ = 0;
  TimeNs grid_ = 0;
  TimeNs t_ref_ = 0;
  std::map<std::string, std::string> keys_;
  std::vector<Segment> segments_;
};

TEST(NefProperty, SpikesDoNotDependOnHowTimeIsCut) {
  for (int seed = 0; seed < test::repetitions(200) && !HasFatalFailure(); ++seed) {
    SCOPED_TRACE(fmt::format("seed {}", seed));
    Trial(seed).run();
  }
}

}  // namespace
}  // namespace spikeloop::testing::nef_property_test
