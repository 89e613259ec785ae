// The node around the expressions, which have a test of their own.
#include <cmath>

#include "sampled_signal.hpp"

namespace spikeloop::testing {
namespace {

using Keys = std::map<std::string, std::string>;

NodeHarness function(const std::string& text, std::uint32_t in, std::uint32_t out, Keys keys = {}) {
  keys["function"] = text;
  return {"function", {in, out}, {.keys = keys}};
}

TEST(Function, EveryExpressionIsAnOutput) {
  NodeHarness node = function("sin(pi*x0); x0*x1; 0.25", 2, 3);
  node.step(kMs);
  EXPECT_EQ(node.revision(), 0U) << "invalid as its input";
  node.set_input({0.5, -3});
  node.step(kMs);
  EXPECT_DOUBLE_EQ(node.output()[0], 1.0);
  EXPECT_EQ(node.output()[1], -1.5);
  EXPECT_EQ(node.output()[2], 0.25);
  node.run_until(kNsPerSecond, kMs);
  EXPECT_EQ(node.revision(), 1U);
  EXPECT_EQ(node.counter("updates"), 1U);
  node.invalidate_input();
  node.step(kMs);
  EXPECT_EQ(node.revision(), 0U);
}

TEST(Function, ValuesDoNotDependOnTheTick) {
  const SampledSignal signal = noise(30, 50 * kMs);
  for (const TimeNs tick : {50 * kMs, 10 * kMs, kMs, kMs / 10}) {
    NodeHarness node = function("2*x^3 - x", 1, 1);
    for (const double x : signal.values) {
      node.set_input({x});
      node.run_until(node.time() + signal.period, tick);
      ASSERT_NEAR(node.output()[0], 2 * x * x * x - x, 1e-15);
    }
    EXPECT_EQ(node.revision(), 30U);
  }
}

TEST(Function, ResultsThatAreNoNumbersAreHeld) {
  NodeHarness node = function("ln(x0); x1", 2, 2);
  node.set_input({-1, 5});
  node.step(kMs);
  EXPECT_EQ(node.revision(), 0U) << "output 0 has not had a value";
  node.set_input({1, 6});
  node.step(kMs);
  EXPECT_EQ(node.output(), (std::vector<double>{0, 6}));
  node.set_input({0, 7});
  node.step(kMs);
  EXPECT_EQ(node.output(), (std::vector<double>{0, 7}));
  EXPECT_EQ(node.revision(), 2U);
  EXPECT_EQ(node.counter("results_not_finite"), 2U);
  EXPECT_EQ(node.counter("inputs_not_finite"), 0U);
  EXPECT_EQ(node.counter("updates"), 2U);
}

TEST(Function, ResultsThatAreNoNumbersMayBeZeroOrAnError) {
  NodeHarness zero = function("1/x0; x0", 1, 2, {{"not_finite", "zero"}});
  zero.set_input({0});
  zero.step(kMs);
  EXPECT_EQ(zero.output(), (std::vector<double>{0, 0}));
  const auto failure = [](const std::string& text, double x) {
    NodeHarness node = function(text, 1, 2, {{"not_finite", "error"}});
    node.set_input({x});
    return message_of([&] { node.step(kMs); });
  };
  EXPECT_EQ(failure("x; 1/x", 0),
            "expression 1 ('1/x') gave inf; keep its inputs where it has a value, or write "
            "not_finite = hold");
  EXPECT_EQ(failure("ln(x); x", -1),
            "expression 0 ('ln(x)') gave nan; keep its inputs where it has a value, or write "
            "not_finite = hold");
}

TEST(Function, InputsThatAreNoNumbersAreHeld) {
  NodeHarness node = function("x0 + 10*x1", 2, 1);
  node.set_input({1, std::nan("")});
  node.step(kMs);
  EXPECT_EQ(node.output()[0], 1.0);
  node.set_input({HUGE_VAL, 2});
  node.step(kMs);
  EXPECT_EQ(node.output()[0], 21.0);
  EXPECT_EQ(node.counter("inputs_not_finite"), 2U);
  EXPECT_EQ(node.counter("results_not_finite"), 0U);
}

TEST(Function, WhatDoesNotFitIsRefused) {
  EXPECT_THAT(message_of([] { function("x0; x1; 1", 2, 2); }),
              Fault("test.yaml:7:3: key 'function': there are 3 expressions, but port 'out' has 2 "
                    "channels ... separated by ';' ... [SL0306]"));
  EXPECT_THAT(message_of([] { function("x0 +", 2, 1); }),
              Fault("test.yaml:7:3: key 'function': 'x0 +', character 4: ... '+' ... [SL0209]"));
  EXPECT_EQ(message_of([] {
              NodeHarness("function", {1, 1});
            }),
            "key 'function' is missing (Expressions of x0, x1, ... (with one input also x), "
            "separated by ';', e.g. sin(pi*x0); x0*x1); write  function=... [SL0104]");
}

}  // namespace
}  // namespace spikeloop::testing
