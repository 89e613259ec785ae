#include "spikeloop/command/component_map.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "spikeloop/command/command_map_node.hpp"

namespace {

using namespace spikeloop::command;
using testing::DoubleEq;
using testing::ElementsAre;
using testing::IsNan;

constexpr double kInf = std::numeric_limits<double>::infinity();

/// What the node with this map puts out.
std::vector<double> map_by_node(const ComponentMap& map, const std::vector<double>& channels) {
  std::vector<double> values(map.size());
  const spikeloop_signal_input input{channels.data(), 1, std::uint32_t(channels.size()), 0};
  spikeloop_signal_output output{values.data(), 0, std::uint32_t(values.size()), 0};
  spikeloop_step data{};
  data.end_ns = 1'000'000;
  data.signal_inputs = &input;
  data.signal_input_count = 1;
  data.signal_outputs = &output;
  data.signal_output_count = 1;
  command_map_class(map).create({})->step(spikeloop::Step(data));
  return values;
}

TEST(ComponentMap, scales_and_limits) {
  const ComponentMap map(
      {{1, 0.5, 0.1, -kInf, kInf}, {0, 1, 0, -0.2, 0.3}, {0, 2, 0, -kInf, kInf}});
  EXPECT_THAT(map_by_node(map, {0.9, -1}), ElementsAre(DoubleEq(-0.4), 0.3, DoubleEq(1.8)));
  EXPECT_THAT(map.deadbands(0.01), ElementsAre(DoubleEq(0.01), DoubleEq(0.005), DoubleEq(0.04)));
}

TEST(ComponentMap, limits_hide_no_fault) {
  const ComponentMap map({{0, 1, 0, -1, 1}, {1, 1, 0, -1, 1}});
  EXPECT_THAT(map_by_node(map, {kInf, std::nan("")}), ElementsAre(kInf, IsNan()));
}

}  // namespace
