// spikeloop-robot on a real ROS: what rospy hears and how the robot obeys.
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "robot_job.hpp"

namespace spikeloop::robot {
namespace {

using nlohmann::json;

constexpr double kPi = std::numbers::pi;

// Stamps rise by the period; a busy machine may lose messages, which leaves whole periods out.
void expect_period(const json& stamps, std::int64_t period) {
  ASSERT_GE(stamps.size(), 5U);
  int exact = 0;
  for (std::size_t i = 1; i < stamps.size(); ++i) {
    const auto step = stamps[i].get<std::int64_t>() - stamps[i - 1].get<std::int64_t>();
    EXPECT_GT(step, 0);
    EXPECT_EQ(step % period, 0);
    exact += step == period ? 1 : 0;
  }
  EXPECT_GT(exact, static_cast<int>(stamps.size()) / 2);
}

class Robot : public testing::Test {
 protected:
  void SetUp() override { job_.start_core(); }
  json drive(const std::string& linear, const std::string& angular,
             const std::string& seconds = "2") {
    const auto outcome = job_.run(job_.probe(seconds, linear, angular));
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    return json::parse(outcome.out);
  }
  RobotJob job_;
};

/// The clock on the wall, since 1970.
std::int64_t wall_ns() {
  return std::chrono::nanoseconds(std::chrono::system_clock::now().time_since_epoch()).count();
}

TEST_F(Robot, InRealTimeStampsAreWallTime) {
  const std::int64_t before = wall_ns();
  test::Child robot(job_.robot({}));
  const json heard = drive("0", "0");
  for (const char* stamps : {"clock_ns", "scan_ns", "odometry_ns"}) {
    EXPECT_GE(heard[stamps].front().get<std::int64_t>(), before) << stamps;
    EXPECT_LE(heard[stamps].back().get<std::int64_t>(), wall_ns()) << stamps;
  }
}

TEST_F(Robot, AtAnotherSpeedStampsAreSimulatedTime) {
  test::Child robot(job_.robot({"--real-time-factor", "2"}));
  EXPECT_LT(drive("0", "0")["clock_ns"].front().get<std::int64_t>(), 1000 * kNsPerSecond);
}

TEST_F(Robot, PublishesScanOdometryAndClockAtTheirRates) {
  test::Child robot(job_.robot({}));
  const json heard = drive("0", "0");
  expect_period(heard["clock_ns"], 10'000'000);
  expect_period(heard["scan_ns"], 50'000'000);
  expect_period(heard["odometry_ns"], 20'000'000);
  EXPECT_EQ(heard["scan_frame"], "laser");
  EXPECT_EQ(heard["odometry_frames"], json::parse(R"(["odom", "base_link"])"));
  EXPECT_EQ(heard["ranges"].size(), 100U);
  EXPECT_NEAR(heard["angle_min"].get<double>(), -kPi / 2, 1e-6);
  EXPECT_NEAR(heard["angle_max"].get<double>(), kPi / 2, 1e-6);
  EXPECT_NEAR(heard["angle_increment"].get<double>(), kPi / 99, 1e-8);
  EXPECT_NEAR(heard["range_max"].get<double>(), 5, 1e-6);
  EXPECT_NEAR(heard["scan_time"].get<double>(), 0.05, 1e-8);
  for (const auto& range : heard["ranges"]) {
    if (range.is_number()) {
      EXPECT_GT(range.get<double>(), heard["range_min"].get<double>());
    } else {
      EXPECT_EQ(range, "inf");
    }
  }
  robot.signal(SIGINT);
  EXPECT_EQ(robot.wait().exit_code, 0);
}

TEST_F(Robot, DrivesAsTwistSays) {
  const std::string world = job_.directory().write(
      "open.xml",
      "<mujoco><include file=\"spikeloop_vehicle.xml\"/><custom>"
      "<numeric name=\"arena\" data=\"-9 -9 9 9\"/><numeric name=\"start\" data=\"0 0 0\"/>"
      "</custom><worldbody><geom name=\"floor\" type=\"plane\" size=\"9 9 1\"/></worldbody>"
      "</mujoco>");
  test::Child robot(job_.robot({"--world", world}));
  const json ahead = drive("0.4", "0");
  EXPECT_NEAR(ahead["speed"].back().get<double>(), 0.4, 0.02);
  EXPECT_NEAR(ahead["y"].back().get<double>(), 0, 0.01);
  EXPECT_GT(ahead["x"].back().get<double>(), 0.3);
  const json turning = drive("0", "0.8");
  EXPECT_NEAR(turning["yaw_rate"].back().get<double>(), 0.8, 0.08);
  const json stopped = drive("nan", "0.8");  // not finite: stop
  EXPECT_NEAR(stopped["speed"].back().get<double>(), 0, 1e-3);
  EXPECT_NEAR(stopped["yaw_rate"].back().get<double>(), 0, 1e-3);
  robot.signal(SIGTERM);
  const auto outcome = robot.wait();
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_FALSE(outcome.says("(0 invalid)")) << outcome.out;
}

TEST_F(Robot, TopicsCanBeRenamed) {
  test::Child robot(job_.robot({"--topic-prefix", "/left", "--scan-topic", "/scan", "--odom-topic",
                                "/odom", "--cmd-topic", "wheels"}));
  drive("0", "0", "0.5");  // /scan, /odom and /clock as they were
  test::Command list = job_.probe("0", "0", "0");
  list.arguments = {"/usr/bin/python3", "-c",
                    "import rosgraph; print(rosgraph.Master('/t').getSystemState())"};
  EXPECT_TRUE(job_.run(list).says("['/left/wheels', ['/spikeloop_robot']]"));
}

// As roslaunch and users write them; ROS_MASTER_URI leads nowhere.
TEST_F(Robot, UnderstandsTheArgumentsOfRos) {
  test::Command command =
      job_.robot({"__name:=left_robot", "/cmd_vel:=/left/wheels", "--seed", "2",
                  "__master:=" + job_.probe("0", "0", "0").environment["ROS_MASTER_URI"]});
  command.environment["ROS_MASTER_URI"] = "http://127.0.0.1:1";
  test::Child robot(command);
  drive("0", "0", "0.5");
  test::Command list = job_.probe("0", "0", "0");
  list.arguments = {"/usr/bin/python3", "-c",
                    "import rosgraph; print(rosgraph.Master('/t').getSystemState())"};
  EXPECT_TRUE(job_.run(list).says("['/left/wheels', ['/left_robot']]"));
}

TEST_F(Robot, ASecondNodeOfTheSameNameEndsTheFirst) {
  test::Child first(job_.robot({}));
  drive("0", "0", "0.2");
  test::Child second(job_.robot({"--duration", "5"}));
  const auto outcome = first.wait();
  EXPECT_EQ(outcome.exit_code, 3);
  EXPECT_TRUE(outcome.says("ROS has shut this node down after ")) << outcome.text();
  EXPECT_TRUE(outcome.says("; does another node have the name 'spikeloop_robot'?"));
  EXPECT_EQ(second.wait().exit_code, 0);
}

}  // namespace
}  // namespace spikeloop::robot
