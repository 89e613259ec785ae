// Rates and weights of networks that are small enough to be followed by hand.
#include <gtest/gtest.h>

#include <cmath>

#include "run_network.hpp"

namespace spikeloop::test {
namespace {

/// Steps of a network whose only ports are `signal` and `rates`.
class RateRunner {
 public:
  explicit RateRunner(const std::string& text, TimeNs tick = kMs, TimeNs begin = 0)
      : network_(parse(text)), node_(make_network(network_)), tick_(tick), now_(begin) {}

  std::vector<double> step(std::vector<double> signal) {
    std::vector<double> rates(network_.rates_width());
    const spikeloop_signal_input in{signal.data(), ++revision_,
                                    static_cast<std::uint32_t>(signal.size()), 0};
    spikeloop_signal_output out{rates.data(), 0, network_.rates_width(), 0};
    const spikeloop_step data{now_, now_ + tick_, &in, nullptr, &out, nullptr, 1, 0, 1, 0};
    node_->step(Step(data));
    now_ += tick_;
    return rates;
  }

  /// Rows are targets.
  WeightTable weights() { return node_->results().at(0).table; }

 private:
  NetworkFile network_;
  std::unique_ptr<Node> node_;
  TimeNs tick_;
  TimeNs now_;
  std::uint64_t revision_ = 0;
};

// exp(-h / tau) = 1/2
const std::string kHalf = "tau: 1.4426950408889634, sigma: 0";

TEST(Rates, RelaxToTheirInput) {
  RateRunner runner(
      "resolution: 1 ms\npopulations:\n  s: {model: signal_input, size: 1}\n"
      "  a: {model: lin_rate_ipn, size: 1, parameters: {" +
      kHalf +
      ", rate: 2}}\n"
      "connections:\n  - {from: s, to: a, rule: one_to_one, weight: 4}\n"
      "rates: [a]\n");
  EXPECT_NEAR(runner.step({0})[0], 1, 1e-15);
  EXPECT_NEAR(runner.step({1})[0], 0.5 + 2, 1e-15);
  EXPECT_NEAR(runner.step({1})[0], 1.25 + 2, 1e-15);
  EXPECT_NEAR(runner.step({0})[0], 1.625, 1e-15);
}

TEST(Rates, DoNotDependOnTheTick) {
  const std::string text =
      "resolution: 0.5 ms\npopulations:\n  s: {model: signal_input, size: 2}\n"
      "  a: {model: threshold_lin_rate_ipn, size: 3, parameters: {tau: 4, rate: 0.2}}\n"
      "  b: {model: sigmoid_rate_ipn, size: 2, parameters: {tau: 3, lambda: 0, sigma: 0.3}}\n"
      "connections:\n  - {from: s, to: a, rule: all_to_all, weight: 0.3}\n"
      "  - {from: a, to: b, rule: all_to_all, weight: 0.2, delay: 4.5 ms}\n"
      "  - {from: b, to: a, rule: all_to_all, weight: -0.2}\n"
      "  - {from: a, to: b, rule: all_to_all, weight: 0.1,\n"
      "     plasticity: {rule: reward_hebbian, reward: r, trace_delay: 7 ms, save: w.npy}}\n"
      "rates: [b, a]\n";
  const std::string with_reward = std::string(text).insert(
      text.find("connections"), "  r: {model: lin_rate_ipn, size: 1, parameters: {mu: 1}}\n");
  const auto run = [&](TimeNs tick, TimeNs begin) {
    RateRunner runner(with_reward, tick, begin);
    std::vector<double> rates;
    for (TimeNs now = 0; now < 60 * kMs; now += tick) {
      rates = runner.step(now < 30 * kMs ? std::vector{1.0, 0.5} : std::vector{0.0, 2.0});
    }
    const auto weights = runner.weights().values;
    rates.insert(rates.end(), weights.begin(), weights.end());
    return rates;
  };
  const std::vector<double> wanted = run(kMs / 2, 0);
  EXPECT_EQ(run(kMs, 0), wanted);
  EXPECT_EQ(run(30 * kMs, 0), wanted);
  EXPECT_NE(run(kMs, 10'000 * kMs), wanted) << "at another time the noise is another";
}

// pre is 1 from the first step on, post follows the signal, the reward is 1 from the second step
// on.
TEST(Rates, LearnWithTheSourceOfTheBeginAndTheTargetOfTheEnd) {
  const std::string fast = "tau: 0.001, sigma: 0";  // the rate is the input of the step's begin
  RateRunner runner(
      "resolution: 1 ms\npopulations:\n  s: {model: signal_input, size: 3}\n"
      "  pre: {model: lin_rate_ipn, size: 1, parameters: {" +
      fast +
      "}}\n"
      "  post: {model: lin_rate_ipn, size: 2, parameters: {" +
      fast +
      "}}\n"
      "  r: {model: lin_rate_ipn, size: 1, parameters: {" +
      fast +
      "}}\n"
      "connections:\n"
      "  - {from: s, to: pre, rule: pairs, pairs: [[0, 0]]}\n"
      "  - {from: s, to: post, rule: pairs, pairs: [[1, 0]]}\n"
      "  - {from: s, to: r, rule: pairs, pairs: [[2, 0]]}\n"
      "  - {from: pre, to: post, rule: all_to_all, weight: 0.5, delay: 1 ms,\n"
      "     plasticity: {rule: reward_hebbian, reward: r, A: 0.125, theta: 0.6,\n"
      "                  Wmax: 0.8, save: w.npy}}\n"
      "rates: [post]\n");
  const auto weights = [&] { return runner.weights().values; };
  runner.step({1, 1, 1});  // pre was 0 at the begin
  EXPECT_EQ(weights(), (std::vector{0.5, 0.5}));
  runner.step({1, 0, 1});  // post is 0 at the end
  EXPECT_EQ(weights(), (std::vector{0.5, 0.5}));
  EXPECT_EQ(runner.step({1, 1, 1})[0], 1.5);  // 1 + 0.5 pre
  EXPECT_EQ(weights(), (std::vector{0.625, 0.5}));
  EXPECT_EQ(runner.step({1, 1, 2})[0], 1.625) << "the new weight carries the rate of its step";
  EXPECT_EQ(weights(), (std::vector{0.8, 0.5})) << "the upper bound";
  runner.step({1, 1, -2});
  EXPECT_NEAR(weights()[0], 0.55, 1e-15) << "the reward of the step's end";
}

}  // namespace
}  // namespace spikeloop::test
