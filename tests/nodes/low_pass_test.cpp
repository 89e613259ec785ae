// The filter against the solution of its equation, segment by segment in long double.
#include <cmath>

#include "sampled_signal.hpp"

namespace spikeloop::testing {
namespace {

using Keys = std::map<std::string, std::string>;

NodeHarness filter(const Keys& keys = {}, std::uint32_t channels = 1) {
  return {"low_pass", {channels, channels}, {.keys = keys}};
}

TEST(LowPass, AStepReachesItsPartAfterTau) {
  NodeHarness node = filter({{"tau", "20 ms"}, {"initial", "0"}}, 2);
  node.set_input({1.0, -3.0});
  node.step(20 * kMs);
  EXPECT_NEAR(node.output()[0], 1 - std::exp(-1.0), 1e-15);
  EXPECT_NEAR(node.output()[1], -3 * (1 - std::exp(-1.0)), 1e-15);
  node.run_until(100 * kMs, kMs);
  EXPECT_NEAR(node.output()[0], 1 - std::exp(-5.0), 1e-15);
}

TEST(LowPass, FollowsASampledSignal) {
  for (const double tau : {0.001, 0.03, 2.0}) {
    const SampledSignal signal = noise(300, 10 * kMs);
    NodeHarness node = filter({{"tau", std::to_string(tau)}, {"initial", "0.5"}});
    long double y = 0.5;
    for (const double x : signal.values) {
      node.set_input({x});
      for (int part = 1; part <= 5; ++part) {
        node.step(2 * kMs);
        const long double expected = x + (y - x) * std::exp(-part * 0.002L / tau);
        ASSERT_NEAR(node.output()[0], static_cast<double>(expected), 1e-13) << tau;
      }
      y = x + (y - x) * std::exp(-0.01L / tau);
    }
  }
}

TEST(LowPass, ValuesDoNotDependOnTheTick) {
  const SampledSignal signal = noise(100, 50 * kMs);
  std::vector<double> reference;
  for (const TimeNs tick : {50 * kMs, 10 * kMs, kMs, kMs / 10}) {
    for (const bool revise : {false, true}) {
      NodeHarness node = filter();
      std::vector<double> all;
      for (const double x : signal.values) {
        node.set_input({x});
        for (const TimeNs end = node.time() + signal.period; node.time() < end;) {
          node.step(tick);
          if (revise) {
            node.set_input({x});
          }
        }
        all.push_back(node.output()[0]);
      }
      reference = reference.empty() ? all : reference;
      EXPECT_EQ(all, reference) << "bit by bit, tick " << tick;
    }
  }
}

TEST(LowPass, BeginsAtTheFirstValueUnlessWritten) {
  NodeHarness node = filter();
  node.run_until(10 * kMs, kMs);
  EXPECT_EQ(node.revision(), 0U);
  node.set_input({0.7});
  node.run_until(100 * kMs, kMs);
  EXPECT_EQ(node.output()[0], 0.7);
  EXPECT_EQ(node.revision(), 1U) << "nothing changes";
  EXPECT_EQ(node.counter("updates"), 1U);
}

TEST(LowPass, RestsWhenItHasArrived) {
  for (const double target : {0.1, 0.0, -1e300}) {
    NodeHarness node = filter({{"tau", "1 ms"}, {"initial", "0.25"}});
    node.set_input({target});
    node.run_until(50 * kMs, kMs);
    EXPECT_EQ(node.output()[0], target);
    const std::uint64_t revision = node.revision();
    EXPECT_LT(revision, 50U);
    node.run_until(kNsPerSecond, kMs);
    EXPECT_EQ(node.revision(), revision);
  }
}

TEST(LowPass, StaysBetweenHugeValues) {
  NodeHarness node = filter({{"tau", "10 ms"}});
  node.set_input({1.7e308});
  node.step(kMs);
  node.set_input({-1.7e308});
  double before = 1.7e308;
  for (int i = 0; i < 1000; ++i) {
    node.step(kMs);
    ASSERT_GE(node.output()[0], -1.7e308);
    ASSERT_LE(node.output()[0], before);
    before = node.output()[0];
  }
  EXPECT_EQ(before, -1.7e308);
}

TEST(LowPass, BeginsAnewAfterAnInvalidInput) {
  NodeHarness node = filter();
  node.set_input({1.0});
  node.step(kMs);
  node.invalidate_input();
  node.step(kMs);
  EXPECT_EQ(node.revision(), 0U);
  node.set_input({-1.0});
  node.step(kMs);
  EXPECT_EQ(node.output()[0], -1.0);
}

TEST(LowPass, NumbersThatAreNoneAreHeld) {
  NodeHarness node = filter({{"tau", "1 ms"}}, 2);
  node.set_input({1.0, std::nan("")});
  node.step(kMs);
  EXPECT_EQ(node.output(), (std::vector<double>{1.0, 0.0})) << "0 while there is no value";
  node.set_input({HUGE_VAL, 3.0});
  node.step(kMs);
  EXPECT_EQ(node.output(), (std::vector<double>{1.0, 3.0})) << "its first value";
  EXPECT_EQ(node.counter("inputs_not_finite"), 2U);
  NodeHarness zero = filter({{"not_finite", "zero"}});
  zero.set_input({std::nan("")});
  zero.step(kMs);
  EXPECT_EQ(zero.output()[0], 0.0);
}

TEST(LowPass, WhatDoesNotFitIsRefused) {
  EXPECT_THAT(message_of([] {
                filter({{"tau", "0"}});
              }),
              Fault("test.yaml:7:3: key 'tau': 0 ... 1e-06 to 1000000 s ... [SL0203]"));
  EXPECT_THAT(message_of([] {
                filter({{"initial", "start"}});
              }),
              Fault("test.yaml:7:3: key 'initial': 'start' ... 'none' ... or none to begin at the "
                    "first input ... [SL0201]"));
}

}  // namespace
}  // namespace spikeloop::testing
