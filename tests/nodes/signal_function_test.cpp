// Nodes that map one continuous signal onto another, against their formulas.
#include <cmath>
#include <random>

#include "harness.hpp"
#include "spikeloop/nodes/register.hpp"

namespace spikeloop::testing {
namespace {

std::vector<double> output_of(const std::string& node_class,
                              const std::map<std::string, std::string>& keys,
                              const std::vector<double>& input, std::uint32_t outputs) {
  NodeHarness node(node_class, {static_cast<std::uint32_t>(input.size()), outputs}, {.keys = keys});
  node.set_input(input);
  node.step(kMs);
  return node.output();
}

TEST(Threshold, IsTheHeavisideFunctionByDefault) {
  EXPECT_EQ(output_of("threshold", {}, {-0.1, 0, 0.1, -7}, 4), (std::vector<double>{0, 1, 1, 0}));
}

TEST(Threshold, MayKeepWhatIsAbove) {
  EXPECT_EQ(
      output_of("threshold",
                {{"threshold", "0.5"}, {"is_heaviside", "false"}, {"scale", "2"}, {"shift", "-1"}},
                {0.25, 0.5, 3}, 3),
      (std::vector<double>{-1, 0, 5}));
}

TEST(Sigmoid, EqualsTheHyperbolicTangent) {
  // 1 / (1 + exp(-z)) = (1 + tanh(z / 2)) / 2: another function of the library.
  for (double x = -5; x <= 5; x += 0.37) {
    const double result = output_of(
        "sigmoid", {{"scale", "3"}, {"slope", "2"}, {"x_offset", "0.5"}, {"y_offset", "-1"}}, {x},
        1)[0];
    EXPECT_NEAR(result, 3 * (1 + std::tanh((2 * x - 0.5) / 2)) / 2 - 1, 1e-14) << x;
  }
}

TEST(Sigmoid, StaysFiniteFarAway) {
  EXPECT_EQ(output_of("sigmoid", {}, {-1e308, 1e308}, 2), (std::vector<double>{0, 1}));
}

TEST(Argmax, IsTheFirstOfTheLargest) {
  EXPECT_EQ(output_of("argmax", {}, {0.1, 0.7, -1, 0.7}, 1), std::vector<double>{1});
  EXPECT_EQ(output_of("argmax", {}, {-3, -3, -3}, 1), std::vector<double>{0});
}

TEST(Argmax, ANumberThatIsNoneIsNeverTheLargest) {
  EXPECT_EQ(output_of("argmax", {}, {std::nan(""), -1, 2}, 1), std::vector<double>{2});
}

struct Grid {
  std::vector<double> values;  // a row a cell: centres, sigmas
  std::uint32_t cells;
  std::uint32_t dimensions;
};

NodeHarness place_cells(const Grid& grid) {
  return {"discretize",
          {grid.dimensions, grid.cells},
          {.weights = WeightTable::dense(grid.cells, 2 * grid.dimensions, grid.values),
           .weights_key = "grid"}};
}

TEST(Discretize, IsAProductOfGaussians) {
  std::mt19937_64 generator(3);
  std::uniform_real_distribution<double> position(-1, 1);
  std::uniform_real_distribution<double> sigma(0.1, 2);
  Grid grid{{}, 5, 3};
  for (std::uint32_t i = 0; i < grid.cells; ++i) {
    for (int j = 0; j < 3; ++j) grid.values.push_back(position(generator));
    for (int j = 0; j < 3; ++j) grid.values.push_back(sigma(generator));
  }
  NodeHarness node = place_cells(grid);
  const std::vector<double> x = {0.3, -0.8, 0.1};
  node.set_input(x);
  node.step(kMs);
  for (std::size_t i = 0; i < 5; ++i) {
    double product = 1;
    for (std::size_t j = 0; j < 3; ++j) {
      const double mu = grid.values[6 * i + j];
      const double s = grid.values[6 * i + 3 + j];
      product *= std::exp(-(x[j] - mu) * (x[j] - mu) / (2 * s * s));
    }
    EXPECT_NEAR(node.output()[i], 2 * product - 1, 1e-14) << i;
  }
}

TEST(Discretize, IsOneAtACentreAndMinusOneFarAway) {
  NodeHarness node = place_cells({{0.5, 0.1, -0.5, 0.1}, 2, 1});
  node.set_input({0.5});
  node.step(kMs);
  EXPECT_EQ(node.output()[0], 1);
  EXPECT_NEAR(node.output()[1], -1, 1e-15);
}

TEST(Discretize, AGridThatDoesNotFitIsRefused) {
  const auto error = [](std::uint32_t rows, std::uint32_t columns, std::vector<double> values) {
    return message_of([&] {
      NodeHarness(
          "discretize", {1, 2},
          {.weights = WeightTable::dense(rows, columns, std::move(values)), .weights_key = "grid"});
    });
  };
  EXPECT_EQ(
      error(2, 1, {0, 0}),
      "test.yaml:8:3: key 'grid': the grid has 2 rows of 1 numbers, but 2 outputs and 1 inputs "
      "need 2 rows of 2: a row a place cell, its centre and then its widths (sigma) [SL0308]");
  EXPECT_EQ(error(2, 2, {0, 1, 0.5, 0}),
            "test.yaml:8:3: key 'grid': row 1 has centre 0.5 and sigma 0 on axis 0; write finite "
            "numbers, and sigma above 0 [SL0308]");
  EXPECT_EQ(error(2, 2, {0, 1, std::nan(""), 1}),
            "test.yaml:8:3: key 'grid': row 1 has centre nan and sigma 1 on axis 0; write finite "
            "numbers, and sigma above 0 [SL0308]");
}

TEST(SignalFunction, OutputsThatLeadNowhereHaveAWidth) {
  Registry registry;
  register_nodes(registry);
  for (const char* name : {"threshold", "sigmoid", "clip", "normalise"}) {
    const WidthRule& width = registry.find(name).description.ports[1].width;
    EXPECT_EQ(width.kind, WidthRule::Kind::same_as) << name;
    EXPECT_EQ(width.value, 0U) << name;
  }
  const WidthRule& width = registry.find("argmax").description.ports[1].width;
  EXPECT_EQ(width.kind, WidthRule::Kind::fixed);
  EXPECT_EQ(width.value, 1U);
}

TEST(SignalFunction, IsIdleAndInvalidAsItsInput) {
  for (const char* name : {"threshold", "sigmoid", "argmax"}) {
    NodeHarness node(name, {1, 1});
    node.step(kMs);
    EXPECT_EQ(node.revision(), 0U) << name;
    node.set_input({0.5});
    node.run_until(10 * kMs, kMs);
    EXPECT_EQ(node.revision(), 1U) << name;
    EXPECT_EQ(node.counter("updates"), 1U) << name;
    node.invalidate_input();
    node.step(kMs);
    EXPECT_EQ(node.revision(), 0U) << name;
  }
}

}  // namespace
}  // namespace spikeloop::testing
