#include "spikeloop/command/component_map.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace {

using namespace spikeloop::command;
using testing::DoubleEq;
using testing::ElementsAre;
using testing::IsNan;

constexpr double kInf = std::numeric_limits<double>::infinity();

TEST(ComponentMap, scales_and_limits) {
  ComponentMap map({{1, 0.5, 0.1, -kInf, kInf}, {0, 1, 0, -0.2, 0.3}, {0, 2, 0, -kInf, kInf}});
  const double channels[] = {0.9, -1};
  EXPECT_THAT(map.map(channels), ElementsAre(DoubleEq(-0.4), 0.3, DoubleEq(1.8)));
  EXPECT_THAT(map.deadbands(0.01), ElementsAre(DoubleEq(0.01), DoubleEq(0.005), DoubleEq(0.04)));
}

TEST(ComponentMap, limits_hide_no_fault) {
  ComponentMap map({{0, 1, 0, -1, 1}, {1, 1, 0, -1, 1}});
  const double channels[] = {kInf, std::nan("")};
  EXPECT_THAT(map.map(channels), ElementsAre(kInf, IsNan()));
}

}  // namespace
