// `clip` and `normalise` against their formulas.
#include <cmath>
#include <limits>

#include "sampled_signal.hpp"

namespace spikeloop::testing {
namespace {

using Keys = std::map<std::string, std::string>;

std::vector<double> mapped(const std::string& node_class, const Keys& keys,
                           const std::vector<double>& x) {
  const auto width = static_cast<std::uint32_t>(x.size());
  NodeHarness node(node_class, {width, width}, {.keys = keys});
  node.set_input(x);
  node.step(kMs);
  return node.output();
}

TEST(Clip, KeepsValuesBetweenItsBounds) {
  EXPECT_EQ(mapped("clip", {}, {-7, -1, -0.5, 0, 1, 1.0001, 1e300}),
            (std::vector<double>{-1, -1, -0.5, 0, 1, 1, 1}));
  EXPECT_EQ(mapped("clip", {{"min", "0.2"}, {"max", "0.2"}}, {-1, 0.2, 1}),
            (std::vector<double>{0.2, 0.2, 0.2}));
  EXPECT_EQ(mapped("clip", {{"min", "3"}, {"max", "1e300"}}, {-1, 17}),
            (std::vector<double>{3, 17}));
}

TEST(Normalise, MapsTheOneRangeOntoTheOther) {
  const Keys keys = {{"in_min", "2"}, {"in_max", "10"}, {"out_min", "-1"}, {"out_max", "3"}};
  EXPECT_EQ(mapped("normalise", keys, {2, 4, 6, 10}), (std::vector<double>{-1, 0, 1, 3}));
  EXPECT_EQ(mapped("normalise", keys, {-50, 50}), (std::vector<double>{-1, 3}));
  EXPECT_EQ(mapped("normalise", {}, {0, 0.25, 1}), (std::vector<double>{-1, -0.5, 1}));
}

TEST(Normalise, MayTurnTheRangeRoundOrCollapseIt) {
  EXPECT_EQ(mapped("normalise", {{"out_min", "1"}, {"out_max", "-1"}}, {0, 0.25, 1, 2}),
            (std::vector<double>{1, 0.5, -1, -1}));
  EXPECT_EQ(mapped("normalise", {{"out_min", "4"}, {"out_max", "4"}, {"clip", "false"}},
                   {0, 0.25, 1.7e308}),
            (std::vector<double>{4, 4, 4}));
}

TEST(Normalise, ExtrapolatesWhenItMay) {
  EXPECT_EQ(mapped("normalise", {{"clip", "false"}}, {-1, 2, 1e6}),
            (std::vector<double>{-3, 3, 1'999'999}));
  const double most = std::numeric_limits<double>::max();
  EXPECT_EQ(mapped("normalise", {{"clip", "false"}, {"in_max", "1e-300"}}, {most, -most, 0}),
            (std::vector<double>{most, -most, -1}))
      << "huge, but numbers";
}

TEST(Normalise, NumbersThatAreNoneAreHeld) {
  for (const char* name : {"clip", "normalise"}) {
    NodeHarness node(name, {1, 1}, {.keys = {}});
    node.set_input({1});
    node.step(kMs);
    for (const double bad : {std::nan(""), HUGE_VAL, -HUGE_VAL}) {
      node.set_input({bad});
      node.step(kMs);
      EXPECT_EQ(node.output()[0], 1.0) << name;
    }
    EXPECT_EQ(node.counter("inputs_not_finite"), 3U);
    EXPECT_EQ(node.counter("updates"), 4U);
  }
}

TEST(Normalise, IsIdleBetweenRevisionsAtEveryTick) {
  const SampledSignal signal = noise(20, 50 * kMs);
  for (const char* name : {"clip", "normalise"}) {
    for (const TimeNs tick : {50 * kMs, 10 * kMs, kMs, kMs / 10}) {
      NodeHarness node(name, {1, 1});
      drive(node, signal, tick);
      EXPECT_EQ(node.counter("updates"), 20U) << name;
      const double x = signal.values.back();
      EXPECT_EQ(node.output()[0],
                name == std::string("clip") ? x : -1 + 2 * std::min(1.0, std::max(0.0, x)));
    }
  }
}

TEST(Normalise, WhatDoesNotFitIsRefused) {
  EXPECT_EQ(message_of([] {
              mapped("clip", {{"min", "2"}}, {0});
            }),
            "test.yaml:7:3: key 'min': 2 is above max, 1; write min at most max [SL0206]");
  EXPECT_EQ(message_of([] {
              mapped("clip", {{"max", "-2"}}, {0});
            }),
            "test.yaml:7:3: key 'min': -1 is above max, -2; write min at most max [SL0206]");
  EXPECT_EQ(
      message_of([] {
        mapped("normalise", {{"in_max", "0"}}, {0});
      }),
      "test.yaml:7:3: key 'in_min': 0 is not below in_max, 0; write in_min below in_max [SL0206]");
}

}  // namespace
}  // namespace spikeloop::testing
