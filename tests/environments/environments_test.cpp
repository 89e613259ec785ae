#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <numbers>
#include <set>

#include "spikeloop/core/error.hpp"
#include "spikeloop/environments/environment.hpp"
#include "tests/support/fault.hpp"

namespace spikeloop::environments {
namespace {

using test::Fault;
using testing::ElementsAre;

std::vector<double> observed(const Environment& environment) {
  return {environment.observation().begin(), environment.observation().end()};
}

std::vector<double> start(Environment& environment, std::uint64_t seed, std::uint64_t episode) {
  environment.reset(seed, episode);
  return observed(environment);
}

/// Of the number of times that each outcome was seen, for these probabilities.
double chi_square(const std::map<double, int>& counts, const std::map<double, double>& expected) {
  int all = 0;
  for (const auto& [outcome, count] : counts) {
    EXPECT_TRUE(expected.contains(outcome)) << outcome;
    all += count;
  }
  double sum = 0;
  for (const auto& [outcome, probability] : expected) {
    const auto count = counts.find(outcome);
    const double mean = probability * all;
    sum += std::pow((count == counts.end() ? 0 : count->second) - mean, 2) / mean;
  }
  return sum;
}

/// With at most three degrees of freedom it is above this by chance once in 20,000 times.
constexpr double kMostChiSquare = 23;

/// With the actions of `policy` until the episode ends.
template <typename Policy>
Outcome run(Environment& environment, Policy policy, std::uint64_t* steps = nullptr) {
  Outcome outcome;
  std::uint64_t step = 0;
  while (step < environment.description().max_steps && !outcome.terminated) {
    outcome = environment.step(policy(environment.observation()));
    ++step;
  }
  if (steps != nullptr) {
    *steps = step;
  }
  return outcome;
}

std::string message(const std::function<void()>& work) {
  try {
    work();
  } catch (const ConfigurationError& error) {
    return error.what();
  }
  return "no error";
}

TEST(Descriptions, AreComplete) {
  std::vector<std::string> names;
  for (const auto& description : descriptions()) {
    names.push_back(description.name);
    const auto environment = make(description.name);
    EXPECT_EQ(environment->description().name, description.name);
    EXPECT_EQ(environment->observation().size(), description.observation.size());
    ASSERT_EQ(description.action.size(), 1U);
    if (description.actions > 0) {
      EXPECT_EQ(description.action[0].low, 0);
      EXPECT_EQ(description.action[0].high, description.actions - 1);
    }
    for (const auto* quantities : {&description.observation, &description.action}) {
      for (const Quantity& quantity : *quantities) {
        EXPECT_FALSE(quantity.name.empty());
        EXPECT_TRUE(std::isfinite(quantity.low) && std::isfinite(quantity.high));
        EXPECT_LT(quantity.low, quantity.high) << description.name << " " << quantity.name;
      }
    }
    EXPECT_EQ(description.text.find('\n'), std::string::npos);
    EXPECT_FALSE(description.text.empty() || description.source.empty());
  }
  EXPECT_THAT(names, ElementsAre("cart_pole", "frozen_lake", "mountain_car", "water_maze"));
}

TEST(Descriptions, HaveTheLimitsOfGymnasiumAndOurSteps) {
  std::map<std::string, std::pair<std::uint64_t, TimeNs>> limits;
  for (const auto& description : descriptions()) {
    limits[description.name] = {description.max_steps, description.step};
  }
  EXPECT_EQ(limits["cart_pole"], std::pair(std::uint64_t{500}, TimeNs{20'000'000}));
  EXPECT_EQ(limits["frozen_lake"], std::pair(std::uint64_t{100}, TimeNs{100'000'000}));
  EXPECT_EQ(limits["mountain_car"], std::pair(std::uint64_t{200}, TimeNs{20'000'000}));
  EXPECT_EQ(limits["water_maze"], std::pair(std::uint64_t{600}, TimeNs{100'000'000}));
}

TEST(Make, BeginsWithEpisode0OfSeed0) {
  for (const auto& description : descriptions()) {
    const auto environment = make(description.name);
    const auto first = observed(*environment);
    EXPECT_EQ(first, start(*environment, 0, 0)) << description.name;
  }
}

TEST(Make, NamesWhatThereIs) {
  EXPECT_EQ(message([] { make("mountin_car"); }),
            "there is no environment 'mountin_car'; did you mean 'mountain_car'? [SL0205]");
  EXPECT_THAT(
      message([] { make("pendulum"); }),
      Fault("... 'pendulum' ... cart_pole, frozen_lake, mountain_car, water_maze ... [SL0205]"));
}

TEST(Reset, IsAFunctionOfSeedAndEpisode) {
  for (const auto& description : descriptions()) {
    const auto environment = make(description.name, {.slippery = true});
    const auto other = make(description.name, {.slippery = true});
    other->reset(9, 9);
    for (int i = 0; i < 5; ++i) {
      other->step(1);
    }
    environment->reset(3, 7);
    other->reset(3, 7);
    for (int i = 0; i < 5; ++i) {
      EXPECT_EQ(observed(*environment), observed(*other)) << description.name;
      EXPECT_EQ(environment->step(0).terminated, other->step(0).terminated);
    }
  }
  for (const char* name : {"cart_pole", "mountain_car"}) {
    const auto environment = make(name);
    std::set<double> starts;
    for (const std::uint64_t seed : {1, 2}) {
      for (const std::uint64_t episode : {0, 1, 2}) {
        starts.insert(start(*environment, seed, episode)[0]);
      }
    }
    EXPECT_EQ(starts.size(), 6U) << name;
  }
}

/// The range, mean and variance of a uniform distribution, and no correlation between episodes.
void expect_uniform(const std::vector<double>& values, double low, double high) {
  const double middle = (low + high) / 2;
  const double variance = (high - low) * (high - low) / 12;
  double sum = 0;
  double squares = 0;
  double products = 0;
  double before = middle;
  for (const double value : values) {
    EXPECT_GE(value, low);
    EXPECT_LE(value, high);
    sum += value - middle;
    squares += (value - middle) * (value - middle);
    products += (value - middle) * (before - middle);
    before = value;
  }
  const auto count = static_cast<double>(values.size());
  EXPECT_NEAR(sum / count, 0, 4 * std::sqrt(variance / count));
  EXPECT_NEAR(squares / count / variance, 1, 4 * std::sqrt(0.8 / count));
  EXPECT_NEAR(products / count / variance, 0, 4 / std::sqrt(count));
}

constexpr std::uint64_t kEpisodes = 10'000;

TEST(Reset, OfTheMountainCarIsUniform) {
  const auto car = make("mountain_car");
  std::vector<double> positions;
  for (std::uint64_t episode = 0; episode < kEpisodes; ++episode) {
    const auto state = start(*car, 1, episode);
    positions.push_back(state[0]);
    ASSERT_EQ(state[1], 0);
  }
  expect_uniform(positions, -0.6, -0.4);
}

TEST(Reset, OfTheCartPoleIsUniform) {
  const auto cart = make("cart_pole");
  std::array<std::vector<double>, 4> values;
  for (std::uint64_t episode = 0; episode < kEpisodes; ++episode) {
    const auto state = start(*cart, 1, episode);
    for (std::size_t i = 0; i < 4; ++i) {
      values[i].push_back(state[i]);
    }
  }
  for (const auto& of_one : values) {
    expect_uniform(of_one, -0.05, 0.05);
  }
  // The four are drawn apart.
  double products = 0;
  for (std::size_t i = 0; i < kEpisodes; ++i) {
    products += values[0][i] * values[1][i] + values[2][i] * values[3][i];
  }
  EXPECT_NEAR(products / kEpisodes / (0.1 * 0.1 / 12), 0, 4 * std::sqrt(2.0 / kEpisodes));
}

TEST(Reset, OfTheWaterMazeChoosesOneOfFourPlaces) {
  const auto maze = make("water_maze");
  std::map<std::vector<double>, double> numbers = {
      {{0, 1}, 0}, {{1, 0}, 1}, {{0, -1}, 2}, {{-1, 0}, 3}};
  std::map<double, int> counts;
  for (std::uint64_t episode = 0; episode < kEpisodes; ++episode) {
    const auto place = start(*maze, 1, episode);
    ASSERT_TRUE(numbers.contains(place));
    ++counts[numbers[place]];
  }
  EXPECT_LT(chi_square(counts, {{0, 0.25}, {1, 0.25}, {2, 0.25}, {3, 0.25}}), kMostChiSquare);
}

TEST(Reset, OfTheFrozenLakeIsTheUpperLeft) {
  const auto lake = make("frozen_lake");
  lake->step(1);
  EXPECT_THAT(start(*lake, 1, 1), ElementsAre(0));
}

TEST(MountainCar, SwingsUntilItReachesTheGoal) {
  const auto car = make("mountain_car");
  for (std::uint64_t episode = 0; episode < 20; ++episode) {
    car->reset(1, episode);
    std::uint64_t steps = 0;
    const Outcome outcome = run(
        *car, [](auto state) { return state[1] < 0 ? 0 : 2; }, &steps);
    EXPECT_TRUE(outcome.terminated && outcome.success);
    EXPECT_EQ(outcome.reward, -1);
    EXPECT_GE(car->observation()[0], 0.5);
    EXPECT_GT(steps, 80U);
    EXPECT_LT(steps, 200U);
  }
}

TEST(MountainCar, IsTooWeakToDriveUpAtOnce) {
  const auto car = make("mountain_car");
  std::uint64_t steps = 0;
  const Outcome outcome = run(
      *car, [](auto) { return 2; }, &steps);
  EXPECT_FALSE(outcome.terminated || outcome.success);
  EXPECT_EQ(outcome.reward, -1);
  EXPECT_EQ(steps, 200U);
}

TEST(MountainCar, StopsAtTheLeftWall) {
  const auto car = make("mountain_car");
  // Swings, but not over the right hill.
  run(*car, [](auto state) { return state[0] > 0.2 || state[1] < 0 ? 0 : 2; });
  bool stopped = false;
  for (int i = 0; i < 500 && !stopped; ++i) {
    const auto state = car->observation();
    car->step(state[0] > 0.2 || state[1] < 0 ? 0 : 2);
    ASSERT_GE(car->observation()[0], -1.2);
    stopped = car->observation()[0] == -1.2;
  }
  ASSERT_TRUE(stopped);
  EXPECT_EQ(car->observation()[1], 0);
}

TEST(CartPole, FallsToTheSideThatTheCartLeaves) {
  const auto cart = make("cart_pole");
  for (const int action : {0, 1}) {
    cart->reset(1, 0);
    const Outcome outcome = run(*cart, [&](auto) { return action; });
    EXPECT_TRUE(outcome.terminated);
    EXPECT_FALSE(outcome.success);
    EXPECT_EQ(outcome.reward, 1);
    const double angle = cart->observation()[2] * 180 / std::numbers::pi;
    EXPECT_GT(action == 1 ? -angle : angle, 12);
    EXPECT_LT(std::abs(angle), 18);
  }
}

/// Balances the pole about `lean`.
int balance(std::span<const double> state, double lean) {
  return state[2] - lean + 0.5 * state[3] > 0 ? 1 : 0;
}

TEST(CartPole, IsBalancedFor500Steps) {
  const auto cart = make("cart_pole");
  for (std::uint64_t episode = 0; episode < 20; ++episode) {
    cart->reset(1, episode);
    std::uint64_t steps = 0;
    const Outcome outcome = run(
        *cart, [](auto state) { return balance(state, -0.03 * state[1] - 0.02 * state[0]); },
        &steps);
    EXPECT_EQ(steps, 500U);
    EXPECT_FALSE(outcome.terminated || outcome.success);
  }
}

TEST(CartPole, EndsWhenTheCartLeavesTheTrack) {
  const auto cart = make("cart_pole");
  for (const double lean : {-0.1, 0.1}) {
    cart->reset(1, 0);
    double before = 0;
    const Outcome outcome = run(*cart, [&](auto state) {
      before = state[0];
      return balance(state, lean);
    });
    EXPECT_TRUE(outcome.terminated);
    EXPECT_FALSE(outcome.success);
    EXPECT_LE(std::abs(before), 2.4);
    EXPECT_GT(lean > 0 ? cart->observation()[0] : -cart->observation()[0], 2.4);
    EXPECT_LT(std::abs(cart->observation()[2]), 0.2);
  }
}

TEST(FrozenLake, HasAWayToTheGoal) {
  const auto lake = make("frozen_lake");
  std::vector<double> fields;
  Outcome outcome;
  for (const int action : {1, 1, 2, 2, 1, 2}) {
    EXPECT_FALSE(outcome.terminated || outcome.success);
    EXPECT_EQ(outcome.reward, 0);
    outcome = lake->step(action);
    fields.push_back(lake->observation()[0]);
  }
  EXPECT_THAT(fields, ElementsAre(4, 8, 9, 10, 14, 15));
  EXPECT_TRUE(outcome.terminated && outcome.success);
  EXPECT_EQ(outcome.reward, 1);
}

TEST(FrozenLake, HasHoles) {
  const auto lake = make("frozen_lake");
  lake->step(2);
  const Outcome outcome = lake->step(1);
  EXPECT_EQ(lake->observation()[0], 5);
  EXPECT_TRUE(outcome.terminated);
  EXPECT_FALSE(outcome.success);
  EXPECT_EQ(outcome.reward, 0);
}

TEST(FrozenLake, EndsAtItsWalls) {
  const auto lake = make("frozen_lake");
  for (const int action : {0, 3}) {
    lake->step(action);
    EXPECT_EQ(lake->observation()[0], 0);
  }
  std::vector<double> fields;
  for (const int action : {2, 2, 2, 2, 3}) {
    lake->step(action);
    fields.push_back(lake->observation()[0]);
  }
  EXPECT_THAT(fields, ElementsAre(1, 2, 3, 3, 3));
}

TEST(FrozenLake, SlipsToEitherSideInTwoStepsOfThree) {
  const auto lake = make("frozen_lake", {.slippery = true});
  // The next field of field 0, for each action.
  constexpr double kThird = 1.0 / 3;
  const std::map<double, double> expected[] = {{{0, 2 * kThird}, {4, kThird}},
                                               {{0, kThird}, {1, kThird}, {4, kThird}},
                                               {{0, kThird}, {1, kThird}, {4, kThird}},
                                               {{0, 2 * kThird}, {1, kThird}}};
  // The first step of an episode, and the later ones.
  std::map<double, int> counts[4][2];
  for (std::uint64_t episode = 0; episode < kEpisodes; ++episode) {
    lake->reset(1, episode);
    const auto action = episode % 4;
    for (int step = 0; step < 20 && lake->observation()[0] == 0; ++step) {
      lake->step(static_cast<double>(action));
      ++counts[action][step > 0][lake->observation()[0]];
    }
  }
  for (std::size_t action = 0; action < 4; ++action) {
    for (const auto& of_steps : counts[action]) {
      EXPECT_LT(chi_square(of_steps, expected[action]), kMostChiSquare) << action;
    }
  }
}

TEST(WaterMaze, HasAPlatform) {
  const auto maze = make("water_maze");
  const auto to_platform = [](auto place) { return std::atan2(0.35 - place[1], 0.35 - place[0]); };
  for (std::uint64_t episode = 0; episode < 20; ++episode) {
    const auto place = start(*maze, 1, episode);
    std::uint64_t steps = 0;
    const Outcome outcome = run(*maze, to_platform, &steps);
    EXPECT_TRUE(outcome.terminated && outcome.success);
    EXPECT_EQ(outcome.reward, 1);
    // 0.02 m a step, to the edge of the platform.
    const double distance = std::hypot(place[0] - 0.35, place[1] - 0.35) - 0.1;
    EXPECT_EQ(steps, std::ceil(distance / 0.02));
  }
}

TEST(WaterMaze, KeepsTheSwimmerInsideItsWall) {
  const auto maze = make("water_maze");
  const auto begin = observed(*maze);
  const double outward = std::atan2(begin[1], begin[0]);
  maze->step(outward);
  EXPECT_NEAR(maze->observation()[0], begin[0], 1e-15);
  EXPECT_NEAR(maze->observation()[1], begin[1], 1e-15);
  // Obliquely to the wall, the swimmer follows it.
  for (int i = 0; i < 100; ++i) {
    const auto place = maze->observation();
    const double radial = std::atan2(place[1], place[0]);
    const Outcome outcome = maze->step(radial + 1);
    EXPECT_FALSE(outcome.terminated || outcome.success);
    EXPECT_EQ(outcome.reward, 0);
    EXPECT_NEAR(std::hypot(place[0], place[1]), 1, 1e-15);
    // (1, 0.02) turned by 1 rad: atan of what it moves along the wall.
    const double turned = std::atan2(0.02 * std::sin(1), 1 + 0.02 * std::cos(1));
    EXPECT_NEAR(
        std::remainder(std::atan2(place[1], place[0]) - radial - turned, 2 * std::numbers::pi), 0,
        1e-12);
  }
}

TEST(WaterMaze, TakesAHeadingOfAnyTurn) {
  const auto maze = make("water_maze");
  const auto other = make("water_maze");
  const double inward = std::atan2(-maze->observation()[1], -maze->observation()[0]);
  maze->step(inward);
  other->step(inward + 2 * std::numbers::pi);
  EXPECT_NEAR(maze->observation()[0], other->observation()[0], 1e-15);
  EXPECT_NEAR(maze->observation()[1], other->observation()[1], 1e-15);
  EXPECT_NEAR(std::hypot(maze->observation()[0], maze->observation()[1]), 0.98, 1e-15);
}

TEST(Action, IsRoundedToTheNearestWholeNumber) {
  const auto lake = make("frozen_lake");
  const std::pair<double, double> actions[] = {{-0.49, 0}, {0.49, 0}, {0.5, 1}, {1.49, 1},
                                               {1.5, 2},   {2.51, 3}, {3.49, 3}};
  const std::map<double, std::vector<double>> reached = {{0, {0}}, {1, {4}}, {2, {1}}, {3, {0}}};
  for (const auto& [action, whole] : actions) {
    lake->reset(1, 0);
    lake->step(action);
    EXPECT_EQ(observed(*lake), reached.at(whole)) << action;
  }
}

TEST(Action, ThatDoesNotExistIsAnError) {
  const auto car = make("mountain_car");
  const auto before = observed(*car);
  EXPECT_THAT(message([&] { car->step(3); }),
              Fault("environment 'mountain_car': there is no action 3 ... 0 to 2 ... [SL0203]"));
  EXPECT_THAT(message([&] { car->step(-0.5); }),
              Fault("environment 'mountain_car': ... -0.5 ... 0 to 2 ... [SL0203]"));
  EXPECT_THAT(message([&] { car->step(1e300); }),
              Fault("environment 'mountain_car': ... 1e+300 ... 0 to 2 ... [SL0203]"));
  EXPECT_THAT(message([&] { car->step(2.5); }),
              Fault("environment 'mountain_car': ... 2.5 ... 0 to 2 ... [SL0203]"));
  EXPECT_EQ(observed(*car), before);
}

TEST(Action, ThatIsNotFiniteIsAnError) {
  const auto cart = make("cart_pole");
  EXPECT_THAT(
      message([&] { cart->step(std::numeric_limits<double>::quiet_NaN()); }),
      Fault("environment 'cart_pole': action nan ... send a value from 0 to 1 ... [SL0201]"));
  const auto maze = make("water_maze");
  const auto before = observed(*maze);
  EXPECT_THAT(message([&] { maze->step(-std::numeric_limits<double>::infinity()); }),
              Fault("environment 'water_maze': action -inf ... -3.141592653589793 to "
                    "3.141592653589793 ... [SL0201]"));
  EXPECT_EQ(observed(*maze), before);
}

}  // namespace
}  // namespace spikeloop::environments
