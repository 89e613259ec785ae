// spikeloop-robot: files, reports, the clock, signals and what it says when it cannot run.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "robot_job.hpp"
#include "spikeloop/status/status.hpp"
#include "tests/support/fault.hpp"

namespace spikeloop::robot {
namespace {

using nlohmann::json;
using test::Fault;

std::vector<std::vector<double>> table(const std::string& csv) {
  std::istringstream lines(csv);
  std::string line;
  std::getline(lines, line);
  std::vector<std::vector<double>> rows;
  while (std::getline(lines, line)) {
    rows.emplace_back();
    std::istringstream cells(line);
    for (std::string cell; std::getline(cells, cell, ',');) rows.back().push_back(std::stod(cell));
  }
  return rows;
}

TEST(RobotRun, LeavesItsPathAndItsWorldAndReports) {
  RobotJob job;
  job.start_core();
  status::Receiver receiver(job.status_socket());
  test::Child robot(
      job.robot({"--duration", "2", "--seed", "4", "--out", job.directory().path() / "a/run"}));
  // Read at once: the socket holds ten messages, and drops some of those that come then.
  std::set<std::string> kinds;
  json report;
  while (report.is_null()) {
    const auto message = receiver.next(std::chrono::seconds(60));
    ASSERT_TRUE(message) << robot.output();
    EXPECT_EQ((*message)["process"], "robot");
    kinds.insert((*message)["type"]);
    if ((*message)["type"] == "report") report = *message;
  }
  const auto outcome = robot.wait();
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_TRUE(outcome.says("2 s simulated in "));

  const std::string csv = job.directory().read("a/run/trajectory.csv");
  EXPECT_TRUE(csv.starts_with("t_s,x_m,y_m,theta_rad,v_m_s,w_rad_s,collisions\n"));
  const auto rows = table(csv);
  ASSERT_EQ(rows.size(), 101U);  // 0, 0.02, ... 2
  for (std::size_t i = 0; i < rows.size(); ++i) {
    EXPECT_NEAR(rows[i][0], 0.02 * static_cast<double>(i), 1e-9);
    EXPECT_EQ(rows[i].size(), 7U);
  }

  const json world = json::parse(job.directory().read("a/run/world.json"));
  EXPECT_EQ(world["seed"], 4);
  EXPECT_EQ(world["arena"]["min_x_m"], -3);
  EXPECT_EQ(world["arena"]["max_y_m"], 3);
  EXPECT_GE(world["obstacles"].size(), 6U);
  EXPECT_NEAR(rows[0][1], world["start"]["x_m"].get<double>(), 1e-6);
  EXPECT_NEAR(rows[0][2], world["start"]["y_m"].get<double>(), 1e-6);
  for (const auto& obstacle : world["obstacles"]) {
    EXPECT_TRUE(obstacle["shape"] == "cylinder" ? obstacle.contains("radius_m")
                                                : obstacle.contains("half_x_m"));
    EXPECT_NEAR(obstacle["height_m"].get<double>(), 0.5, 1e-12);  // arena.xml
  }
  EXPECT_NEAR(world["arena"]["wall_height_m"].get<double>(), 0.5, 1e-12);
  // spikeloop_vehicle.xml: the body, on it the mast, half its height.
  EXPECT_NEAR(world["vehicle_height_m"].get<double>(), 0.08 + 0.095 + 0.015, 1e-12);

  EXPECT_EQ(kinds, (std::set<std::string>{"started", "first_tick", "progress", "report"}));
  EXPECT_EQ(report["summary"]["collisions"], 0);
  EXPECT_NEAR(report["summary"]["distance_m"].get<double>(), 0, 1e-3);
  EXPECT_TRUE(report["summary"].contains("coverage"));
  EXPECT_TRUE(report["summary"].contains("mean_speed_m_s"));
  EXPECT_EQ(report["counters"]["scans"], 40);
  EXPECT_TRUE(report["counters"].contains("overruns"));
}

double wall_seconds(const std::string& text) {
  const std::string words = " simulated in ";
  return std::stod(text.substr(text.find(words) + words.size()));
}

TEST(RobotRun, KeepsTheRealTimeFactor) {
  RobotJob job;
  job.start_core();
  const auto slow = job.run(job.robot({"--duration", "1", "--real-time-factor", "0.5"}));
  EXPECT_GE(wall_seconds(slow.out), 1.9) << slow.text();
  // Eight times: a machine that is four times too slow for it still runs ahead of real time.
  const auto fast = job.run(job.robot({"--duration", "16", "--real-time-factor", "8"}));
  EXPECT_GE(wall_seconds(fast.out), 1.9) << fast.text();
  EXPECT_LT(wall_seconds(fast.out), 16) << fast.text();
}

TEST(RobotRun, SignalsEndItCleanly) {
  RobotJob job;
  job.start_core();
  for (const int number : {SIGINT, SIGTERM, SIGUSR1}) {
    test::Child robot(job.robot({"--out", job.directory().path()}));
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(60);
    while (table(job.directory().read_complete_lines("trajectory.csv")).size() < 50 &&
           std::chrono::steady_clock::now() < end) {
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
    robot.signal(number);
    const auto outcome = robot.wait();
    EXPECT_EQ(outcome.exit_code, 0) << number << ": " << outcome.text();
    EXPECT_TRUE(outcome.says(" simulated in "));
    const std::string csv = job.directory().read("trajectory.csv");
    EXPECT_TRUE(csv.ends_with("\n"));
    EXPECT_EQ(table(csv).back().size(), 7U);
    std::filesystem::remove(job.directory().path() / "trajectory.csv");
  }
}

// What the program prints when it fails, without the end of the line.
void expect_failure(const RobotJob& job, std::vector<std::string> arguments, int exit_code,
                    const std::string& message) {
  status::Receiver receiver(job.status_socket());
  const auto outcome = job.run(job.robot(arguments));
  EXPECT_EQ(outcome.exit_code, exit_code);
  EXPECT_THAT(outcome.err, Fault("spikeloop-robot: " + message + "\n"));
  const auto failure = receiver.next(std::chrono::milliseconds(100));
  ASSERT_TRUE(failure);
  EXPECT_EQ((*failure)["type"], "failure");
  EXPECT_EQ((*failure)["exit_code"], exit_code);
  EXPECT_THAT((*failure)["message"].get<std::string>(), Fault(message));
}

TEST(RobotErrors, NoMaster) {
  RobotJob job;
  const ReservedPort port;
  const std::string uri = "http://127.0.0.1:" + port.text();
  job.set_master(uri);
  status::Receiver receiver(job.status_socket());
  const auto outcome = job.run(job.robot({"--master-timeout", "0.3"}));
  EXPECT_EQ(outcome.exit_code, 3);
  EXPECT_THAT(outcome.err, Fault("spikeloop-robot: ... " + uri +
                                 " ... 300 ms (Connection refused) ... [SL0701]\n"));
  EXPECT_EQ((*receiver.next(std::chrono::milliseconds(100)))["exit_code"], 3);
}

TEST(RobotErrors, AMasterWithoutAnAddress) {
  RobotJob job;
  job.set_master("http://no-such-host.invalid:11311");
  const auto outcome = job.run(job.robot({"--master-timeout", "0"}));
  EXPECT_EQ(outcome.exit_code, 3);
  EXPECT_THAT(outcome.err, Fault("spikeloop-robot: ... http://no-such-host.invalid:11311 ... 0 s "
                                 "... 'IP-ADDRESS no-such-host.invalid' ... [SL0701]\n"));
}

TEST(RobotRun, CanBeStoppedWhileItWaitsForTheMaster) {
  for (const int number : {SIGINT, SIGTERM}) {
    RobotJob job;
    const test::SilentHost host;
    job.set_master(host.uri());
    test::Child robot(job.robot({"--master-timeout", "100"}));
    ASSERT_TRUE(host.connected(std::chrono::seconds(60)));
    const auto asked = std::chrono::steady_clock::now();
    robot.signal(number);
    const auto outcome = robot.wait();
    EXPECT_EQ(outcome.exit_code, 0) << outcome.text();
    EXPECT_EQ(outcome.text(), "");
    EXPECT_LT(std::chrono::steady_clock::now() - asked, std::chrono::seconds(20));
  }
}

TEST(RobotErrors, AMalformedMaster) {
  RobotJob job;
  job.set_master("elsewhere");
  expect_failure(job, {}, 2,
                 "ROS_MASTER_URI is 'elsewhere' ... http://HOST:PORT, as in http://localhost:11311 "
                 "... [SL0510]");
}

TEST(RobotErrors, Names) {
  RobotJob job;
  job.start_core();
  expect_failure(job, {"--scan-topic", "/my scan"}, 2,
                 "'/my scan' ... ROS topic name; write letters, digits, '_' and '/' ... '/', as in "
                 "/cmd_vel ... [SL0501]");
  expect_failure(job, {"--cmd-topic", "a-b"}, 2,
                 "'a-b' ... ROS topic name; write letters, digits, '_' and '/' ... '/', as in "
                 "/cmd_vel ... [SL0501]");
  const std::string node = "'a/b' ... ROS node name ... digits and '_' ... [SL0501]";
  expect_failure(job, {"--node-name", "a/b"}, 2, node);
  expect_failure(job, {"__name:=a/b"}, 2, node);
  expect_failure(job, {"/my scan:=/scan"}, 2,
                 "an argument NAME:=VALUE for ROS has no name of ROS: Character [ ] at element [3] "
                 "is not valid in Graph Resource Name [/my scan].  Valid characters are a-z, A-Z, "
                 "0-9, / and _. [SL0501]");
}

TEST(RobotErrors, Files) {
  RobotJob job;
  job.start_core();
  expect_failure(job, {"--world", "/nowhere/arena.xml"}, 4,
                 "cannot open world '/nowhere/arena.xml': ... [SL0109]");
  expect_failure(job, {"--out", "/dev/null/run"}, 4,
                 "cannot make directory '/dev/null/run': Not a directory [SL0109]");
  std::filesystem::create_directories(job.directory().path() / "run/trajectory.csv");
  expect_failure(job, {"--out", "run"}, 4,
                 "cannot create 'run/trajectory.csv': Is a directory [SL0109]");
  std::filesystem::create_directories(job.directory().path() / "other/world.json");
  expect_failure(job, {"--out", "other"}, 4,
                 "cannot write 'other/world.json': Is a directory [SL0109]");
  expect_failure(job, {"--out", "/dev/null"}, 4,
                 "cannot make directory '/dev/null': Not a directory [SL0109]");
}

TEST(RobotErrors, CommandLine) {
  RobotJob job;
  const auto of = [&](std::vector<std::string> arguments) { return job.run(job.robot(arguments)); };
  EXPECT_EQ(of({"--sede", "3"}).exit_code, 2);
  EXPECT_TRUE(of({"--sede", "3"}).says("--sede"));
  EXPECT_EQ(of({"--real-time-factor", "0"}).exit_code, 2);
  EXPECT_TRUE(of({"--real-time-factor", "0"}).says("not in range 0.001000 to 1000.000000"))
      << of({"--real-time-factor", "0"}).text();
  for (const char* option : {"--duration", "--clock-rate", "--master-timeout"}) {
    EXPECT_TRUE(of({option, "nan"}).says("Value nan not in range")) << option;
  }
  EXPECT_EQ(of({"--version"}).exit_code, 0);
  EXPECT_TRUE(of({"--version"}).says("spikeloop-robot "));
  const auto help = of({"--help"});
  EXPECT_EQ(help.exit_code, 0);
  EXPECT_TRUE(help.says("Examples:"));
  EXPECT_TRUE(help.says("Exit codes:"));
}

}  // namespace
}  // namespace spikeloop::robot
