// Episodes: when they end, what is told, what is written; an environment as a robot.
#include "spikeloop/robot/episodes.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>

#include "spikeloop/core/error.hpp"
#include "spikeloop/robot/environment_robot.hpp"
#include "tests/support/temporary_directory.hpp"

namespace spikeloop::robot::episodes_test {
namespace {

using testing::ElementsAre;

constexpr TimeNs kMs = 1'000'000;

std::string read(const std::filesystem::path& path) {
  std::ostringstream text;
  text << std::ifstream(path).rdbuf();
  return text.str();
}

TEST(Episodes, EndByTheirTaskOrByTime) {
  const test::TemporaryDirectory folder;
  Episodes episodes({.step = 10 * kMs, .count = 2, .time_limit = 30 * kMs, .pause = 10 * kMs},
                    folder.path().string());
  episodes.begin(0);
  episodes.step(10 * kMs, {.reward = 2});
  EXPECT_THAT(episodes.state(), ElementsAre(1, 1, 1, 2));
  episodes.step(20 * kMs, {.reward = 0.5, .terminated = true, .success = true});
  EXPECT_THAT(episodes.state(), ElementsAre(1, 0, 2, 2.5));
  EXPECT_TRUE(episodes.terminated() && episodes.success());
  EXPECT_FALSE(episodes.wait(25 * kMs));
  EXPECT_FALSE(episodes.in_pause());
  EXPECT_FALSE(episodes.wait(30 * kMs));
  EXPECT_TRUE(episodes.in_pause());
  EXPECT_TRUE(episodes.wait(40 * kMs));
  episodes.begin(40 * kMs);
  for (const TimeNs time : {50 * kMs, 60 * kMs, 70 * kMs}) {
    EXPECT_TRUE(episodes.running());
    EXPECT_FALSE(episodes.terminated() || episodes.success()) << "as the one before";
    episodes.step(time, {.reward = -1});
  }
  EXPECT_FALSE(episodes.terminated() || episodes.success());
  EXPECT_FALSE(episodes.over());
  EXPECT_FALSE(episodes.wait(kNsPerSecond));
  EXPECT_TRUE(episodes.over());
  episodes.finish();
  EXPECT_EQ(read(folder.path() / kEpisodesFile),
            "episode,begin_s,end_s,steps,return,success,end\n"
            "1,0,0.02,2,2.5,1,terminated\n"
            "2,0.04,0.07,3,-3,0,time_limit\n");
  EXPECT_EQ(
      episodes.summary(),
      (nlohmann::json{
          {"episodes", 2}, {"successes", 1}, {"median_return", -0.25}, {"mean_return", -0.25}}));
}

TEST(Episodes, TheRewardThatIsToldIsNotTheReturn) {
  Episodes episodes({.hold = kMs, .pause = kMs, .begin_reward = -1, .end_reward = -0.4}, "");
  episodes.begin(0);
  EXPECT_EQ(episodes.told_reward(), -1);
  episodes.step(kMs, {.reward = -2});
  EXPECT_EQ(episodes.told_reward(), -2);
  episodes.step(2 * kMs, {.reward = -2, .terminated = true});
  EXPECT_EQ(episodes.told_reward(), -0.4);
  EXPECT_EQ(episodes.state().back(), -4);
  episodes.wait(3 * kMs);
  EXPECT_EQ(episodes.told_reward(), -1);
}

TEST(Episodes, FailureIsAnEndWithoutReward) {
  Episodes episodes({.failure_reward = -0.1}, "");
  episodes.begin(0);
  episodes.step(kMs, {.reward = 0, .terminated = true});
  EXPECT_EQ(episodes.told_reward(), -0.1);
  episodes.begin(2 * kMs);
  EXPECT_EQ(episodes.told_reward(), 0);
  episodes.step(3 * kMs, {.reward = 1, .terminated = true, .success = true});
  EXPECT_EQ(episodes.told_reward(), 1);
}

TEST(Episodes, LastingIsSuccess) {
  Episodes episodes({.time_limit = 2 * kMs, .lasts = true}, "");
  episodes.begin(0);
  episodes.step(kMs, {.reward = 1, .terminated = true});
  episodes.begin(2 * kMs);
  episodes.step(3 * kMs, {.reward = 1});
  episodes.step(4 * kMs, {.reward = 1});
  EXPECT_EQ(episodes.summary()["successes"], 1);
}

TEST(Episodes, AFolderThatIsNotThere) {
  EXPECT_THROW(Episodes({}, "/nonexistent"), FileError);
}

class Environments : public testing::Test {
 protected:
  static std::map<std::string, std::vector<double>> publish(EnvironmentRobot& robot, TimeNs time) {
    std::map<std::string, std::vector<double>> numbers;
    robot.publish(
        time, [](std::size_t) { return true; },
        [&](std::size_t topic, std::span<const std::byte> message) {
          reader_.read(message, numbers[robot.topics()[topic].name]);
        });
    return numbers;
  }
  static void act(EnvironmentRobot& robot, double action) {
    NumbersMessage message(messages::Dialect::ros1);
    robot.command(message.write(std::vector{action}));
  }

  static inline const messages::FieldReader reader_{
      messages::Catalog::builtin(messages::Dialect::ros1), kNumbersType, "data"};
};

TEST_F(Environments, PublishAtStepsAndWaitForAnAction) {
  EnvironmentRobot robot({.name = "frozen_lake", .step = 10 * kMs});
  EXPECT_THAT(publish(robot, 0)["observation"], ElementsAre(0));
  robot.advance(10 * kMs);
  EXPECT_THAT(publish(robot, 10 * kMs)["episode"], ElementsAre(1, 1, 0, 0)) << "no action yet";
  EXPECT_TRUE(publish(robot, 15 * kMs).empty());
  act(robot, 1);  // down
  robot.advance(15 * kMs);
  robot.advance(20 * kMs);
  auto told = publish(robot, 20 * kMs);
  EXPECT_THAT(told["observation"], ElementsAre(4));
  EXPECT_THAT(told["scaled_observation"], ElementsAre(testing::DoubleEq(4 * 2 / 15. - 1)));
  EXPECT_THAT(told["episode"], ElementsAre(1, 1, 1, 0));
}

/// However late its first action comes, an episode has all of its steps.
TEST_F(Environments, TimeBeginsWithTheFirstAction) {
  EnvironmentRobot robot({.name = "water_maze", .episodes = {.time_limit = 300 * kMs}});
  constexpr TimeNs kStep = 100 * kMs;
  robot.advance(2 * kStep);
  act(robot, 0);
  robot.advance(3 * kStep);
  for (int step = 1; step <= 3; ++step) {
    robot.advance((3 + step) * kStep);
    EXPECT_THAT(publish(robot, (3 + step) * kStep)["episode"],
                ElementsAre(1, step < 3 ? 1 : 0, step, 0));
  }
}

TEST_F(Environments, PauseAndBeginAnew) {
  EnvironmentRobot robot({.name = "frozen_lake",
                          .step = 10 * kMs,
                          .pause_observation = 9999,
                          .episodes = {.pause = 15 * kMs, .failure_reward = -0.1}});
  act(robot, 1);
  robot.advance(5 * kMs);
  robot.advance(10 * kMs);  // 4
  act(robot, 2);            // 5, a hole
  robot.advance(15 * kMs);
  robot.advance(20 * kMs);
  auto told = publish(robot, 20 * kMs);
  EXPECT_THAT(told["observation"], ElementsAre(5));
  EXPECT_THAT(told["reward"], ElementsAre(-0.1));
  EXPECT_THAT(told["episode"], ElementsAre(1, 0, 2, 0));
  robot.advance(30 * kMs);
  told = publish(robot, 30 * kMs);
  EXPECT_THAT(told["observation"], ElementsAre(9999));
  EXPECT_THAT(told["reward"], ElementsAre(0));
  EXPECT_THAT(told["episode"], ElementsAre(1, 0, 2, 0));
  robot.advance(40 * kMs);
  EXPECT_THAT(publish(robot, 40 * kMs)["episode"], ElementsAre(1, 0, 2, 0));
  robot.advance(50 * kMs);  // the first step after another 15 ms
  told = publish(robot, 50 * kMs);
  EXPECT_THAT(told["observation"], ElementsAre(0));
  EXPECT_THAT(told["episode"], ElementsAre(2, 1, 0, 0));
  EXPECT_EQ(robot.summary()["successes"], 0);
}

TEST_F(Environments, AnActionThatDoesNotExistEndsTheRun) {
  EnvironmentRobot robot({.name = "mountain_car"});
  act(robot, 3);
  robot.advance(20 * kMs);
  EXPECT_THROW(robot.advance(40 * kMs), ConfigurationError);
}

}  // namespace
}  // namespace spikeloop::robot::episodes_test
