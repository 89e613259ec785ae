// What comes out against what went in.
#include <cmath>
#include <optional>
#include <random>

#include "sampled_signal.hpp"

namespace spikeloop::testing {
namespace {

using Keys = std::map<std::string, std::string>;

NodeHarness delayed(const std::string& delay, std::uint32_t channels = 1) {
  return {"delay", {channels, channels}, {.keys = {{"delay", delay}}}};
}

TEST(Delay, GivesTheValueBackAfterTheDelay) {
  NodeHarness node = delayed("10 ms", 2);
  node.step(5 * kMs);
  node.set_input({0.5, -3});
  node.run_until(15 * kMs, kMs);
  EXPECT_EQ(node.revision(), 0U) << "during (14 ms, 15 ms] the input of 4 ms counts";
  node.step(kMs);
  EXPECT_EQ(node.output(), (std::vector<double>{0.5, -3}));
  EXPECT_EQ(node.revision(), 1U);
  node.run_until(kNsPerSecond, kMs);
  EXPECT_EQ(node.revision(), 1U);
  EXPECT_EQ(node.counter("updates"), 1U);
}

TEST(Delay, OfNothingIsTheInput) {
  NodeHarness node = delayed("0");
  for (const double x : {0.5, 0.25, 7.0}) {
    node.set_input({x});
    node.step(kMs);
    EXPECT_EQ(node.output()[0], x);
  }
}

// The newest value at or before t - delay, by search.
TEST(Delay, EqualsASearchInThePast) {
  std::mt19937_64 generator(6);
  for (const TimeNs delay : {TimeNs{0}, kMs, 7 * kMs, 7 * kMs + 1, kMs / 3, 200 * kMs}) {
    NodeHarness node = delayed(std::to_string(delay) + " ns");
    std::vector<std::pair<TimeNs, std::optional<double>>> past;
    for (int i = 0; i < 2000; ++i) {
      const TimeNs now = node.time();
      const auto dice = generator() % 10;
      if (dice < 5) {
        past.emplace_back(now, static_cast<double>(i));
        node.set_input({static_cast<double>(i)});
      } else if (dice == 9 && !past.empty() && past.back().second) {
        past.emplace_back(now, std::nullopt);
        node.invalidate_input();
      }
      node.step(static_cast<TimeNs>(1 + generator() % (2 * kMs)));
      std::optional<double> expected;
      for (const auto& [time, value] : past) {
        expected = time <= now - delay ? value : expected;
      }
      ASSERT_EQ(node.revision() != 0, expected.has_value()) << delay << " " << i;
      if (expected) {
        ASSERT_EQ(node.output()[0], *expected) << delay << " " << i;
      }
    }
  }
}

TEST(Delay, ValuesDoNotDependOnTheTick) {
  const SampledSignal signal = noise(40, 50 * kMs);
  for (const TimeNs tick : {50 * kMs, 10 * kMs, kMs, kMs / 10}) {
    NodeHarness node = delayed("150 ms");
    for (std::size_t i = 0; i < signal.values.size(); ++i) {
      node.set_input({signal.values[i]});
      node.run_until(signal.period * static_cast<TimeNs>(i + 1), tick);
      if (i >= 3) {
        ASSERT_EQ(node.output()[0], signal.values[i - 3]) << tick;
      }
    }
  }
}

TEST(Delay, ARevisionOfAnEqualValueIsOneAgain) {
  NodeHarness node = delayed("5 ms");
  for (int i = 0; i < 20; ++i) {
    node.set_input({0.5});
    node.step(kMs);
  }
  EXPECT_EQ(node.revision(), 15U);
}

TEST(Delay, NumbersThatAreNoneAreHeld) {
  NodeHarness node = delayed("1 ms", 2);
  node.set_input({std::nan(""), 2});
  node.step(kMs);
  node.set_input({3, HUGE_VAL});
  node.step(kMs);
  EXPECT_EQ(node.output(), (std::vector<double>{0, 2}));
  node.step(kMs);
  EXPECT_EQ(node.output(), (std::vector<double>{3, 2}));
  EXPECT_EQ(node.counter("inputs_not_finite"), 2U);
}

TEST(Delay, MustNotBeNegative) {
  EXPECT_THAT(message_of([] { delayed("-1 ms"); }),
              Fault("test.yaml:7:3: key 'delay': -0.001 ... 0 to 1000000 s ... [SL0203]"));
}

}  // namespace
}  // namespace spikeloop::testing
