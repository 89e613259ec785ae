#include <cmath>
#include <limits>
#include <random>

#include "harness.hpp"

namespace spikeloop::testing {
namespace {

struct Problem {
  WeightTable weights;
  std::vector<double> input;
};

Problem random_problem(std::uint32_t rows, std::uint32_t columns, double density, unsigned seed) {
  std::mt19937_64 generator(seed);
  std::normal_distribution<double> normal;
  std::bernoulli_distribution present(density);
  Problem problem;
  std::vector<double> values(std::size_t{rows} * columns);
  for (double& value : values) {
    value = present(generator) ? normal(generator) : 0.0;
  }
  problem.weights = WeightTable::dense(rows, columns, values);
  for (std::uint32_t j = 0; j < columns; ++j) {
    problem.input.push_back(normal(generator));
  }
  return problem;
}

std::vector<double> result_of(const WeightTable& weights, std::uint32_t rows,
                              const std::vector<double>& input) {
  NodeHarness node("connect", {static_cast<std::uint32_t>(input.size()), rows},
                   {.weights = weights});
  node.set_input(input);
  node.step(kMs);
  return node.output();
}

TEST(Connect, EqualsTheNaiveProduct) {
  for (const auto& [rows, columns] : std::vector<std::pair<std::uint32_t, std::uint32_t>>{
           {1, 1}, {1, 7}, {3, 8}, {5, 9}, {17, 100}, {2, 1000}, {100, 3}}) {
    const Problem problem = random_problem(rows, columns, 1.0, rows + columns);
    const std::vector<double> result = result_of(problem.weights, rows, problem.input);
    for (std::uint32_t i = 0; i < rows; ++i) {
      long double sum = 0;
      long double scale = 0;
      for (std::uint32_t j = 0; j < columns; ++j) {
        const long double term =
            static_cast<long double>(problem.weights.at(i, j)) * problem.input[j];
        sum += term;
        scale += std::fabs(term);
      }
      EXPECT_NEAR(result[i], static_cast<double>(sum),
                  static_cast<double>(scale) * 1.2e-16 * (columns / 8.0 + 5))
          << rows << " x " << columns;
    }
  }
}

TEST(Connect, SparseEqualsDenseBitByBit) {
  for (const double density : {0.0, 0.1, 0.5, 1.0}) {
    const Problem problem = random_problem(20, 333, density, 7);
    EXPECT_EQ(result_of(problem.weights, 20, problem.input),
              result_of(problem.weights.compressed(), 20, problem.input))
        << density;
  }
}

TEST(Connect, OneToOneEqualsItsDenseFormBitByBit) {
  const std::vector<double> input = {0.1, -0.7, 1e-300};
  const std::vector<double> result = result_of(WeightTable::one_to_one(0.3), 3, input);
  EXPECT_EQ(result,
            result_of(WeightTable::dense(3, 3, {0.3, 0, 0, 0, 0.3, 0, 0, 0, 0.3}), 3, input));
  EXPECT_EQ(result, (std::vector<double>{0.3 * 0.1, 0.3 * -0.7, 0.3 * 1e-300}));
}

TEST(Connect, UniformIsTheMeanOrTheWeightTimesTheSum) {
  const std::vector<double> input = {0.5, 1.0, -0.25, 0.75};
  EXPECT_EQ(result_of(WeightTable::uniform(), 2, input), (std::vector<double>{0.5, 0.5}));
  EXPECT_EQ(result_of(WeightTable::uniform(3.0), 1, input), (std::vector<double>{6.0}));
  NodeHarness by_default("connect", {4, 1});
  by_default.set_input(input);
  by_default.step(kMs);
  EXPECT_EQ(by_default.output(), std::vector<double>{0.5});
}

TEST(Connect, OutputIsInvalidUntilAndWhileTheInputIs) {
  NodeHarness node("connect", {1, 1}, {.weights = WeightTable::one_to_one()});
  node.step(kMs);
  EXPECT_EQ(node.revision(), 0U);
  node.set_input({0.5});
  node.step(kMs);
  EXPECT_EQ(node.revision(), 1U);
  EXPECT_EQ(node.output()[0], 0.5);
  node.invalidate_input();
  node.step(kMs);
  EXPECT_EQ(node.revision(), 0U);
  node.set_input({0.25});
  node.step(kMs);
  EXPECT_EQ(node.revision(), 1U);
  EXPECT_EQ(node.output()[0], 0.25);
}

TEST(Connect, IsIdleWhileTheRevisionIsUnchanged) {
  NodeHarness node("connect", {2, 1});
  node.set_input({0.5, std::nan("")});
  node.run_until(100 * kMs, kMs);
  EXPECT_EQ(node.revision(), 1U);
  EXPECT_EQ(node.counter("updates"), 1U);
  EXPECT_EQ(node.counter("inputs_not_finite"), 1U) << "once a revision, not once a tick";
  node.set_input({0.5, 0.5});
  node.run_until(200 * kMs, kMs);
  EXPECT_EQ(node.revision(), 2U);
  EXPECT_EQ(node.counter("updates"), 2U);
}

TEST(Connect, NotFiniteInputsAreHeldChannelByChannel) {
  constexpr double kInf = std::numeric_limits<double>::infinity();
  NodeHarness node("connect", {3, 3}, {.weights = WeightTable::one_to_one()});
  node.set_input({0.5, std::nan(""), -kInf});
  node.step(kMs);
  EXPECT_EQ(node.output(), (std::vector<double>{0.5, 0.0, 0.0})) << "0 if there was none yet";
  node.set_input({kInf, 2.0, -3e300});
  node.step(kMs);
  EXPECT_EQ(node.output(), (std::vector<double>{0.5, 2.0, -3e300})) << "any finite value passes";
  node.set_input({0.25, -kInf, std::nan("")});
  node.step(kMs);
  EXPECT_EQ(node.output(), (std::vector<double>{0.25, 2.0, -3e300}));
  EXPECT_EQ(node.counter("inputs_not_finite"), 5U);
}

TEST(Connect, NotFiniteInputsMayBecomeZero) {
  NodeHarness node("connect", {1, 1},
                   {.keys = {{"not_finite", "zero"}}, .weights = WeightTable::one_to_one()});
  node.set_input({0.5});
  node.step(kMs);
  node.set_input({std::numeric_limits<double>::infinity()});
  node.step(kMs);
  EXPECT_EQ(node.output()[0], 0.0);
  EXPECT_EQ(node.counter("inputs_not_finite"), 1U);
}

TEST(Connect, NotFiniteInputsMayEndTheRun) {
  for (const auto& [value, text] : std::vector<std::pair<double, std::string>>{
           {std::nan(""), "nan"},
           {-std::nan(""), "nan"},
           {-std::numeric_limits<double>::infinity(), "-inf"}}) {
    NodeHarness node("connect", {2, 1}, {.keys = {{"not_finite", "error"}}});
    node.set_input({0.0, value});
    EXPECT_THAT(message_of([&] { node.step(kMs); }),
                Fault("input channel 1 has the value " + text + " ... not_finite = hold"));
  }
}

std::string weight_error(const WeightTable& weights, const std::string& node_class = "connect") {
  return message_of([&] { NodeHarness(node_class, {3, 2}, {.weights = weights}); });
}

TEST(Connect, WeightsThatDoNotFitAreRefused) {
  EXPECT_THAT(weight_error(WeightTable::dense(3, 2, std::vector<double>(6))),
              Fault("test.yaml:8:3: key 'weights': ... 3 rows and 2 columns ... 2 outputs and 3 "
                    "inputs ... [SL0308]"));
  EXPECT_THAT(
      weight_error(WeightTable::one_to_one()),
      Fault("test.yaml:8:3: key 'weights': one-to-one ... 2 outputs and 3 inputs ... [SL0308]"));
  EXPECT_THAT(weight_error(WeightTable::dense(2, 3, {1, 2, 3, 4, 5})),
              Fault("test.yaml:8:3: key 'weights': the weights hold 5 numbers, but 2 rows of 3 "
                    "columns need 6 ... [SL0308]"));
  EXPECT_EQ(weight_error(WeightTable::dense(2, 3, {1, 2, 3, std::nan(""), 5, 6})),
            "test.yaml:8:3: key 'weights': weight 3 of 6 is not finite; write a number [SL0201]");
  EXPECT_THAT(weight_error(WeightTable::even()),
              Fault("test.yaml:8:3: key 'weights': 'even' stands for no weights here; write a "
                    "weight file, 'uniform' or 'one_to_one' [SL0308]"));
}

TEST(Connect, MalformedSparseWeightsAreRefused) {
  WeightTable table = WeightTable::dense(2, 3, {1, 0, 2, 0, 3, 0}).compressed();
  WeightTable foreign_column = table;
  foreign_column.column[2] = 3;
  EXPECT_EQ(weight_error(foreign_column),
            "test.yaml:8:3: key 'weights': the weights name column 3, but there are 3 inputs; "
            "columns count from 0 [SL0308]");
  WeightTable short_rows = table;
  short_rows.row_start.pop_back();
  const std::string expected =
      "test.yaml:8:3: key 'weights': the sparse weights hold 3 numbers, 3 columns and 2 row "
      "starts, "
      "which do not describe 2 rows; write rows + 1 ascending row starts, and a column for each "
      "number [SL0308]";
  EXPECT_EQ(weight_error(short_rows), expected);
  EXPECT_EQ(weight_error(short_rows, "linear_readout"), expected);
}

}  // namespace
}  // namespace spikeloop::testing
