// A ROS master that the launcher finds missing, or starts and stops.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <chrono>

#include "spikeloop/launch/ros_master.hpp"
#include "spikeloop/processes/reserved_port.hpp"
#include "tests/launch/launcher.hpp"
#include "tests/support/fault.hpp"

namespace spikeloop::test {
namespace {

using namespace std::chrono_literals;

std::string closed_uri() {
  static const ReservedPort port;
  return "http://127.0.0.1:" + port.text();
}

TEST(RosMasterOfAJob, IsMissed) {
  const TwoPrograms job("", "", "./ros_sensor_adapter");
  std::filesystem::create_symlink(SPIKELOOP_TEST_PROGRAM,
                                  job.directory().path() / "ros_sensor_adapter");
  Command command = job.command();
  command.environment["ROS_MASTER_URI"] = closed_uri();
  const Outcome outcome = run(command);
  EXPECT_EQ(outcome.exit_code, 3);
  EXPECT_EQ(last_line(outcome.err),
            "spikeloop: no ROS master answers at " + command.environment["ROS_MASTER_URI"] +
                "; start one (roscore), write its address into ROS_MASTER_URI, or let us start one "
                "of our own: --roscore [SL0701]");
}

TEST(RosMasterOfAJob, HasNoAddress) {
  const TwoPrograms job("", "", "./ros_sensor_adapter");
  std::filesystem::create_symlink(SPIKELOOP_TEST_PROGRAM,
                                  job.directory().path() / "ros_sensor_adapter");
  Command command = job.command();
  command.environment["ROS_MASTER_URI"] = "http://no-such-host.invalid:11311";
  const Outcome outcome = run(command);
  EXPECT_EQ(outcome.exit_code, 3);
  EXPECT_THAT(
      last_line(outcome.err),
      Fault("spikeloop: ... http://no-such-host.invalid:11311: ... 'IP-ADDRESS "
            "no-such-host.invalid' ... or write another address into ROS_MASTER_URI [SL0701]"));
}

TEST(RosMasterOfAJob, IsStartedAndStopped) {
  const TwoPrograms job("stoptime=1000", "stoptime=1000");
  Command command = job.command({"--roscore"});
  command.environment["ROS_MASTER_URI"] = closed_uri();
  Child child(command);
  ASSERT_TRUE(child.wait_for("spikeloop: ROS master at http", 60s)) << child.output();
  ASSERT_TRUE(child.wait_for("b: first tick", 60s)) << child.output();
  std::string uri = child.output();
  uri = uri.substr(uri.find("ROS master at ") + 14);
  const launch::RosMaster master(uri.substr(0, uri.find('\n')));
  EXPECT_TRUE(master.answers());
  EXPECT_FALSE(master.publishes("/scan"));
  child.signal(SIGINT);
  const Outcome outcome = child.wait();
  EXPECT_EQ(outcome.exit_code, 130);
  EXPECT_EQ(outcome.left_behind, 0);
  EXPECT_FALSE(master.answers());
}

TEST(RosMasterOfAJob, DiesWithAKilledLauncher) {
  const TwoPrograms job("stoptime=1000", "stoptime=1000");
  Command command = job.command({"--roscore"});
  command.environment["ROS_MASTER_URI"] = closed_uri();
  Child child(command);
  ASSERT_TRUE(child.wait_for("b: first tick", 90s)) << child.output();
  child.signal(SIGKILL);
  EXPECT_EQ(child.wait().left_behind, 0);
}

/// A job with the real robot.
Outcome run_with_robot(const TwoPrograms& job, const std::vector<std::string>& more) {
  std::vector<std::string> arguments{"--roscore", "--robot"};
  arguments.insert(arguments.end(), more.begin(), more.end());
  Command command = job.command(arguments);
  command.environment["ROS_MASTER_URI"] = closed_uri();
  return run(command);
}

TEST(RobotOfAJob, DrivesAndReports) {
  const TwoPrograms job("stoptime=2", "stoptime=2");
  const Outcome outcome = run_with_robot(job, {"--seed", "3", "--real-time-factor", "0.5"});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.text();
  EXPECT_EQ(outcome.left_behind, 0);
  auto summary = job.summary();
  EXPECT_EQ(summary["processes"]["robot"]["reported"], true) << "it was asked to stop, not killed";
  EXPECT_TRUE(summary["distance_m"].is_number());
  EXPECT_TRUE(std::filesystem::exists(job.folder() + "/trajectory.csv"));
}

TEST(RobotOfAJob, MayHaveOtherTopics) {
  const TwoPrograms job("stoptime=1", "stoptime=1");
  const Outcome outcome = run_with_robot(job, {"--robot-arg=--scan-topic=/Pioneer3AT/laserscan"});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.text();
}

TEST(RobotOfAJob, FailsWithItsReason) {
  const TwoPrograms job;
  const Outcome outcome = run_with_robot(job, {"--robot-arg=--world=nope.xml"});
  EXPECT_EQ(outcome.exit_code, 4);
  EXPECT_EQ(last_line(outcome.err).find("spikeloop: robot: cannot find world 'nope.xml'"), 0u);
  EXPECT_EQ(outcome.left_behind, 0);
}

TEST(RobotOfAJob, ThatDoesNotKnowAnArgumentIsNamed) {
  const TwoPrograms job;
  const Outcome outcome = run_with_robot(job, {"--robot-arg=--wrld=x"});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_EQ(
      last_line(outcome.err).find("spikeloop: robot: ended with exit code 2; its last line: "), 0u)
      << outcome.err;
  EXPECT_NE(outcome.text().find("--wrld=x"), std::string::npos);
}

TEST(RobotOfAJob, ThatEndsTakesTheJobWithIt) {
  const TwoPrograms job("stoptime=1000", "stoptime=1000");
  // Long enough for the programs to have begun on a busy machine.
  const Outcome outcome = run_with_robot(job, {"--robot-arg=--duration=6"});
  EXPECT_EQ(outcome.exit_code, 3) << outcome.text();
  EXPECT_EQ(last_line(outcome.err)
                .find("spikeloop: robot: ended before the job, with exit code 0; its last line: "),
            0u)
      << outcome.err;
  EXPECT_EQ(job.summary()["processes"]["a"]["reported"], true) << "the programs finalized";
  EXPECT_EQ(outcome.left_behind, 0);
}

/// The process of the family with this name; 0 when there is none.
pid_t member(const Child& child, const std::string& name) {
  for (const pid_t process : child.family()) {
    std::ifstream file("/proc/" + std::to_string(process) + "/comm");
    std::string comm;
    if (std::getline(file, comm) && comm == name) {
      return process;
    }
  }
  return 0;
}

TEST(RobotOfAJob, ThatIsToldToEndTakesTheJobWithIt) {
  const TwoPrograms job("stoptime=1000", "stoptime=1000");
  Command command = job.command({"--roscore", "--robot"});
  command.environment["ROS_MASTER_URI"] = closed_uri();
  Child child(command);
  ASSERT_TRUE(child.wait_for("b: first tick", 90s)) << child.output();
  const pid_t robot = member(child, "spikeloop-robot");
  ASSERT_GT(robot, 0);
  kill(robot, SIGTERM);
  const Outcome outcome = child.wait();
  EXPECT_EQ(outcome.exit_code, 3) << outcome.text();
  EXPECT_THAT(last_line(outcome.err),
              testing::MatchesRegex("spikeloop: robot: ended before the job, with exit code 0; its "
                                    "last line: [0-9.]+ m?s simulated in .*"));
  EXPECT_EQ(job.summary()["exit_code"], 3);
  EXPECT_EQ(job.summary()["processes"]["a"]["reported"], true) << "the programs finalized";
  EXPECT_EQ(outcome.left_behind, 0);
}

}  // namespace
}  // namespace spikeloop::test
