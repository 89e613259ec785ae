#include "spikeloop/command/mapping.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace {

using namespace spikeloop::command;
using spikeloop::CommandField;
using testing::DoubleEq;
using testing::ElementsAre;
using testing::IsNan;

constexpr double kInf = std::numeric_limits<double>::infinity();

/// Output of the node with these components.
std::vector<double> map_by_node(const std::vector<CommandField>& map,
                                const std::vector<double>& channels) {
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

TEST(CommandMap, scales_and_limits) {
  const std::vector<CommandField> map = {
      {"x", 1, 0.5, 0.1}, {"y", 0, 1, 0, -0.2, 0.3}, {"z", 0, 2, 0}};
  EXPECT_THAT(map_by_node(map, {0.9, -1}), ElementsAre(DoubleEq(-0.4), 0.3, DoubleEq(1.8)));
  EXPECT_THAT(deadbands(map, 0.01), ElementsAre(DoubleEq(0.01), DoubleEq(0.005), DoubleEq(0.04)));
}

TEST(CommandMap, limits_hide_no_fault) {
  const std::vector<CommandField> map = {{"x", 0, 1, 0, -1, 1}, {"y", 1, 1, 0, -1, 1}};
  EXPECT_THAT(map_by_node(map, {kInf, std::nan("")}), ElementsAre(kInf, IsNan()));
}

}  // namespace
