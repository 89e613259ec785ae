// Weights and errors against solutions by hand and by another method.
#include "spikeloop/fit/regression.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "spikeloop/core/error.hpp"

namespace spikeloop::fit {
namespace {

TEST(Regression, TwoNeuronsByHand) {
  // Samples a = (1, 0), (0, 1), (1, 1) with y = 1, 2, 4; r = 0: normal equations by hand.
  Regression regression(2, 1);
  for (const auto& [a, b, y] :
       {std::array{1.0, 0.0, 1.0}, std::array{0.0, 1.0, 2.0}, std::array{1.0, 1.0, 4.0}}) {
    regression.add(std::array{a, b}, std::array{y});
  }
  const auto weights = regression.solve(0);
  // [[2, 1], [1, 2]] w = (5, 6)
  EXPECT_NEAR(weights[0], 4.0 / 3, 1e-12);
  EXPECT_NEAR(weights[1], 7.0 / 3, 1e-12);
  // All three samples are missed by 1/3.
  EXPECT_NEAR(regression.errors(weights).total, 1.0 / 3, 1e-12);
  // r = 1: 3 more on the diagonal.
  const auto small = regression.solve(1);
  EXPECT_NEAR(small[0], 19.0 / 24, 1e-12);
  EXPECT_NEAR(small[1], 25.0 / 24, 1e-12);
}

/// Gradient descent on the same cost: another method, to convergence.
std::vector<double> by_descent(const std::vector<std::vector<double>>& activities,
                               const std::vector<double>& targets, double strength) {
  const std::size_t neurons = activities[0].size();
  const auto samples = static_cast<double>(targets.size());
  std::vector<double> weights(neurons, 0.0);
  for (int round = 0; round < 2000; ++round) {
    std::vector<double> slope(neurons);
    for (std::size_t n = 0; n < neurons; ++n) {
      slope[n] = strength * strength * weights[n];
    }
    for (std::size_t k = 0; k < targets.size(); ++k) {
      double miss = -targets[k];
      for (std::size_t n = 0; n < neurons; ++n) {
        miss += weights[n] * activities[k][n];
      }
      for (std::size_t n = 0; n < neurons; ++n) {
        slope[n] += miss * activities[k][n] / samples;
      }
    }
    for (std::size_t n = 0; n < neurons; ++n) {
      weights[n] -= 0.2 * slope[n];
    }
  }
  return weights;
}

TEST(Regression, MinimisesTheCostOverManySamples) {
  constexpr std::size_t kNeurons = 7;
  std::mt19937_64 generator(1);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  std::vector<std::vector<double>> activities;
  std::vector<double> targets;
  Regression regression(kNeurons, 2);
  double highest = 0;
  for (int k = 0; k < 700; ++k) {  // more than the samples that are added up at once
    std::vector<double> row(kNeurons);
    double sum = 0;
    for (double& a : row) {
      a = uniform(generator);
      highest = std::max(highest, a);
      sum += a * a;
    }
    activities.push_back(row);
    targets.push_back(sum);
    regression.add(row, std::array{sum, 1 - sum});
  }
  const auto weights = regression.solve(0.3);
  const auto expected = by_descent(activities, targets, 0.3 * highest);
  for (std::size_t n = 0; n < kNeurons; ++n) {
    EXPECT_NEAR(weights[n], expected[n], 1e-6);
  }
  Evaluation evaluation(weights, kNeurons);
  for (std::size_t k = 0; k < activities.size(); ++k) {
    evaluation.add(activities[k], std::array{targets[k], 1 - targets[k]});
  }
  const Errors inside = regression.errors(weights);
  const Errors again = evaluation.errors();
  EXPECT_EQ(again.samples, 700U);
  EXPECT_NEAR(inside.total, again.total, 1e-9);
  EXPECT_NEAR(inside.of_output[0], again.of_output[0], 1e-9);
  EXPECT_NEAR(inside.of_output[1], again.of_output[1], 1e-9);
}

std::string error_of(const Regression& regression, double regularisation) {
  try {
    regression.solve(regularisation);
  } catch (const ConfigurationError& error) {
    return error.what();
  }
  return "";
}

TEST(Regression, SaysWhyThereAreNoWeights) {
  Regression nothing(2, 1);
  EXPECT_EQ(error_of(nothing, 0.1), "there is no sample to fit to; fit to a longer time");
  nothing.add(std::array{0.0, 0.0}, std::array{1.0});
  EXPECT_EQ(error_of(nothing, 0.1),
            "no neuron has fired; give inputs at which the neurons fire, or a longer time");
  Regression alike(2, 1);
  alike.add(std::array{1.0, 1.0}, std::array{1.0});
  alike.add(std::array{2.0, 2.0}, std::array{2.0});
  EXPECT_EQ(error_of(alike, 0),
            "the equations have no unique solution: some neurons do the same, or never fire; write "
            "a regularisation above 0, such as 0.01");
  EXPECT_EQ(error_of(alike, 0.1), "");
}

}  // namespace
}  // namespace spikeloop::fit
