// What nobody inside the job can do: a zero command when the command adapter itself is killed or
// stopped. These are safety deadlines: they may be asserted.
#include <gmock/gmock.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>

#include "guarded_job.hpp"
#include "spikeloop/core/priority.hpp"
#include "spikeloop/core/time.hpp"

namespace {

using namespace spikeloop::test;
using ros_peer::eventually;
using ros_peer::monotonic_now;
using ros_peer::Twist;
using testing::HasSubstr;
using testing::Not;

/// Cases with a deadline (REAL_TIME_CASES in CMakeLists.txt), and those without.
using GuardTest = GuardedJob;
using PatientGuardTest = GuardedJob;

TEST_F(GuardTest, adapter_killed) {
  ASSERT_NO_FATAL_FAILURE(run_until_it_drives("stoptime=100"));
  const pid_t adapter = named("ros_command_ada");
  const auto begin = monotonic_now();
  kill(adapter, SIGKILL);
  expect_zero_since(begin, "adapter killed");
  EXPECT_TRUE(eventually(10, [&] { return guards_commands() == 5; }));
  const auto outcome = child_->wait();
  EXPECT_EQ(outcome.left_behind, 0);
  EXPECT_THAT(outcome.text(), HasSubstr("spikeloop: warning: the robot on /cmd_vel is stopped: its "
                                        "command adapter 'command' has died"));
  EXPECT_EQ(outcome.exit_code, 128 + SIGKILL) << outcome.text();
}

TEST_F(GuardTest, adapter_stopped) {
  ASSERT_NO_FATAL_FAILURE(run_until_it_drives("stoptime=100"));
  const pid_t adapter = named("ros_command_ada");
  auto begin = monotonic_now();
  kill(adapter, SIGSTOP);
  expect_zero_since(begin, "adapter stopped");
  ASSERT_TRUE(
      child_->wait_for("its command adapter 'command' has not been heard for 200 ms "
                       "(stopped by SIGSTOP, or the machine is too busy)",
                       std::chrono::seconds(10)))
      << child_->output();
  const std::size_t zeros = settled_number_of_commands();
  begin = monotonic_now();
  kill(adapter, SIGCONT);
  expect_zero_since(begin, "adapter continued");
  EXPECT_TRUE(
      child_->wait_for("the command adapter 'command' is heard again", std::chrono::seconds(10)));
  ASSERT_TRUE(eventually(20, [&] {
    const auto twists = robot_.twists();
    return twists.size() > zeros + 5 && !twists.back().is_zero() &&
           twists.back().time_ns - begin > 1'400'000'000;
  })) << "the adapter drives again";
  EXPECT_EQ(guards_commands(zeros), 0) << "the guard does not fight with the adapter";
  // A command may still leave before the adapter hears of the signal; its zero follows.
  expect_quiet_after_zero(begin, 1'400'000'000);
  child_->signal(SIGINT);
  EXPECT_EQ(child_->wait().left_behind, 0);
}

TEST_F(PatientGuardTest, stopped_adapter_killed) {
  ASSERT_NO_FATAL_FAILURE(run_until_it_drives("stoptime=100"));
  const pid_t adapter = named("ros_command_ada");
  kill(adapter, SIGSTOP);
  ASSERT_TRUE(child_->wait_for("has not been heard", std::chrono::seconds(10)));
  const std::size_t zeros = settled_number_of_commands();
  EXPECT_TRUE(robot_.twists().back().is_zero());
  kill(adapter, SIGKILL);
  // The robot stands already: no deadline.
  EXPECT_TRUE(eventually(30, [&] { return robot_.twists().size() > zeros; }));
  EXPECT_EQ(child_->wait().left_behind, 0);
  EXPECT_EQ(guards_commands(zeros), static_cast<std::ptrdiff_t>(robot_.twists().size() - zeros));
  EXPECT_TRUE(robot_.twists().back().is_zero());
}

TEST_F(GuardTest, launcher_and_mpirun_killed_at_once) {
  ASSERT_NO_FATAL_FAILURE(run_until_it_drives("stoptime=100"));
  const pid_t mpirun = named("mpirun");
  ASSERT_GT(mpirun, 0);
  const auto begin = monotonic_now();
  child_->signal(SIGKILL);
  kill(mpirun, SIGKILL);
  expect_zero_since(begin, "launcher and mpirun killed at once");
  expect_nothing_left(begin);
}

TEST_F(GuardTest, everything_else_killed_at_once) {
  ASSERT_NO_FATAL_FAILURE(run_until_it_drives("stoptime=100"));
  const auto begin = kill_all_but_guard();
  expect_zero_since(begin, "everything but the guard killed at once");
  expect_nothing_left(begin);
  EXPECT_THAT(child_->wait().err,
              HasSubstr("spikeloop-guard: warning: the robot on /cmd_vel is stopped: its command "
                        "adapter 'command' has died"))
      << "the launcher is no longer there to say it";
}

TEST_F(GuardTest, everything_stopped_then_killed) {
  ASSERT_NO_FATAL_FAILURE(run_until_it_drives("stoptime=100"));
  const pid_t adapter = named("ros_command_ada");
  const auto begin = monotonic_now();
  kill(adapter, SIGSTOP);
  child_->signal(SIGKILL);
  expect_zero_since(begin, "adapter stopped and launcher killed");
  expect_nothing_left(begin);
}

TEST_F(GuardTest, adapter_shut_down_by_ros) {
  ASSERT_NO_FATAL_FAILURE(run_until_it_drives("stoptime=100"));
  const auto outcome = expect_zero_after_shut_down("/ros_command_node");
  EXPECT_THAT(outcome.err, HasSubstr("spikeloop: command: the ROS node /ros_command_node_"));
  EXPECT_THAT(outcome.err, HasSubstr(" has been shut down: another node took its name, or it was "
                                     "ended by  rosnode kill [SL0703]\n"));
  EXPECT_EQ(outcome.left_behind, 0);
}

TEST_F(GuardTest, sensor_shut_down_by_ros) {
  ASSERT_NO_FATAL_FAILURE(run_until_it_drives("stoptime=100"));
  const auto outcome = expect_zero_after_shut_down("/ros_sensor_node");
  EXPECT_THAT(outcome.err, HasSubstr("spikeloop: sensor: the ROS node /ros_sensor_node_"));
}

TEST_F(GuardTest, master_killed_before) {
  ASSERT_NO_FATAL_FAILURE(run_until_it_drives("stoptime=100"));
  core_.signal(SIGKILL);
  const pid_t adapter = named("ros_command_ada");
  const auto begin = monotonic_now();
  kill(adapter, SIGKILL);
  expect_zero_since(begin, "adapter killed, master gone");
  EXPECT_EQ(child_->wait().left_behind, 0);
}

TEST_F(GuardTest, master_that_hangs) {
  ASSERT_NO_FATAL_FAILURE(run_until_it_drives("stoptime=100"));
  core_.signal(SIGSTOP);
  const auto begin = kill_all_but_guard();
  expect_zero_since(begin, "all killed, master hangs");
  expect_nothing_left(begin);
  core_.signal(SIGCONT);
}

TEST_F(GuardTest, launcher_killed_while_the_master_hangs) {
  ASSERT_NO_FATAL_FAILURE(run_until_it_drives("stoptime=100"));
  core_.signal(SIGSTOP);
  const auto begin = monotonic_now();
  child_->signal(SIGKILL);
  await_launchers_death();  // for whoever reads a failure: on a busy machine it may come late
  std::printf("the launcher died after %.1f ms\n",
              1e-6 * static_cast<double>(monotonic_now() - begin));
  expect_zero_since(begin, "launcher killed, master hangs");
  expect_nothing_left(begin);
  core_.signal(SIGCONT);
}

TEST_F(PatientGuardTest, good_end) {
  ASSERT_NO_FATAL_FAILURE(run_until_it_drives("stoptime=5"));
  EXPECT_TRUE(eventually(4, [&] { return robot_.publishers("/cmd_vel") == 2; }))
      << "the robot listens to the guard before there is need";
  int allowed = SCHED_OTHER;
  std::thread([&] {
    spikeloop::run_before_others();
    allowed = sched_getscheduler(0);
  }).join();
  EXPECT_EQ(sched_getscheduler(named("spikeloop-guard")), allowed);
  const auto threads =
      std::filesystem::directory_iterator(fmt::format("/proc/{}/task", named("ros_command_ada")));
  EXPECT_TRUE(std::any_of(begin(threads), end(threads), [&](const auto& thread) {
    return sched_getscheduler(std::stoi(thread.path().filename())) == allowed;
  })) << "the adapter's stopping thread";
  const auto outcome = child_->wait();
  EXPECT_EQ(outcome.exit_code, 0) << outcome.text();
  EXPECT_EQ(outcome.left_behind, 0);
  expect_no_zero_of_the_guard(outcome);
}

TEST_F(PatientGuardTest, ctrl_c) {
  ASSERT_NO_FATAL_FAILURE(run_until_it_drives("stoptime=100"));
  child_->signal(SIGINT);
  const auto outcome = child_->wait();
  EXPECT_EQ(outcome.exit_code, 130) << outcome.text();
  EXPECT_EQ(outcome.left_behind, 0);
  expect_no_zero_of_the_guard(outcome);
}

TEST_F(PatientGuardTest, guard_killed) {
  ASSERT_NO_FATAL_FAILURE(run_until_it_drives("stoptime=100"));
  const pid_t first = named("spikeloop-guard");
  kill(first, SIGKILL);
  EXPECT_TRUE(
      child_->wait_for("spikeloop: warning: spikeloop-guard has ended; it is started again. Until "
                       "then nothing stops the robot when its command adapter is killed or stopped",
                       std::chrono::seconds(10)))
      << child_->output();
  EXPECT_TRUE(
      child_->wait_for("the guard has ended. Nothing stops the robot when this program is "
                       "killed or stopped",
                       std::chrono::seconds(10)))
      << child_->output();
  const std::size_t before = robot_.twists().size();
  EXPECT_TRUE(eventually(10, [&] {
    const auto twists = robot_.twists();
    return twists.size() > before + 5 && !twists.back().is_zero();
  })) << "the job goes on";
  EXPECT_TRUE(child_->wait_for("the guard watches over /cmd_vel again", std::chrono::seconds(10)))
      << child_->output();
  EXPECT_NE(named("spikeloop-guard"), first);
  kill(named("ros_command_ada"), SIGKILL);
  EXPECT_TRUE(eventually(10, [&] { return guards_commands() > 0; })) << "of the second guard";
  const auto outcome = child_->wait();
  EXPECT_EQ(outcome.exit_code, 128 + SIGKILL) << outcome.text();
  EXPECT_EQ(outcome.left_behind, 0);
  EXPECT_TRUE(robot_.twists().back().is_zero());
}

TEST_F(PatientGuardTest, guard_and_adapter_killed_at_once) {
  ASSERT_NO_FATAL_FAILURE(run_until_it_drives("stoptime=100"));
  const std::vector<pid_t> both{named("spikeloop-guard"), named("ros_command_ada")};
  child_->signal(SIGSTOP);  // the launcher would restart the guard
  kill_all(both, SIGKILL);
  child_->signal(SIGCONT);
  const auto outcome = child_->wait();
  EXPECT_EQ(outcome.exit_code, 128 + SIGKILL);
  EXPECT_THAT(outcome.err,
              HasSubstr("(Killed); no stop command could be sent to the robot: stop it "
                        "by hand\n"));
}

TEST_F(GuardTest, a_stopped_guard_is_continued) {
  ASSERT_NO_FATAL_FAILURE(run_until_it_drives("stoptime=100"));
  const auto begin = monotonic_now();
  kill(named("spikeloop-guard"), SIGSTOP);
  kill(named("ros_command_ada"), SIGKILL);
  expect_zero_since(begin, "guard stopped, adapter killed");
  const auto outcome = child_->wait();
  EXPECT_THAT(outcome.err, HasSubstr("spikeloop: warning: spikeloop-guard had been stopped "
                                     "(SIGSTOP); it was continued\n"));
  EXPECT_EQ(outcome.left_behind, 0);
}

TEST_F(GuardTest, launcher_stopped) {
  ASSERT_NO_FATAL_FAILURE(run_until_it_drives("stoptime=100"));
  const auto begin = monotonic_now();
  child_->signal(SIGSTOP);
  expect_zero_since(begin, "launcher stopped");
  const std::size_t before = robot_.twists().size();
  ASSERT_TRUE(eventually(10, [&] { return robot_.twists().size() > before + 10; }))
      << "zeros are repeated";
  expect_quiet_after_zero(begin, spikeloop::kNever);
  child_->signal(SIGCONT);
  EXPECT_TRUE(eventually(10, [&] { return !robot_.twists().back().is_zero(); }))
      << "it drives again";
  child_->signal(SIGINT);
  const auto outcome = child_->wait();
  EXPECT_EQ(outcome.exit_code, 130) << outcome.text();
  EXPECT_THAT(outcome.err, HasSubstr("the robot is stopped: the launcher or mpirun is stopped "
                                     "(SIGSTOP), or the machine is too busy"));
}

TEST_F(GuardTest, mpirun_stopped) {
  ASSERT_NO_FATAL_FAILURE(run_until_it_drives("stoptime=100"));
  const auto begin = monotonic_now();
  const pid_t mpirun = named("mpirun");
  kill(mpirun, SIGSTOP);
  expect_zero_since(begin, "mpirun stopped");
  EXPECT_TRUE(child_->wait_for(
      fmt::format("spikeloop: warning: process {0} (mpirun) has been stopped (SIGSTOP); the robot "
                  "is stopped until it continues:  kill -CONT {0}",
                  mpirun),
      std::chrono::seconds(10)))
      << child_->output();
  child_->signal(SIGINT);
  EXPECT_EQ(child_->wait().left_behind, 0);
}

TEST_F(GuardTest, guard_stopped_delays_nothing) {
  ASSERT_NO_FATAL_FAILURE(run_until_it_drives("stoptime=100"));
  kill(named("spikeloop-guard"), SIGSTOP);
  const std::size_t before = robot_.twists().size();
  ASSERT_TRUE(eventually(10, [&] { return robot_.twists().size() > before + 25; }));
  EXPECT_EQ(guards_commands(before), 0) << "its own absence is not the adapter's";
  EXPECT_TRUE(std::ranges::none_of(robot_.twists(), &Twist::is_zero));
  child_->signal(SIGINT);
  EXPECT_EQ(child_->wait().left_behind, 0);
}

TEST_F(PatientGuardTest, guard_stopped_at_the_end) {
  ASSERT_NO_FATAL_FAILURE(run_until_it_drives("stoptime=100"));
  kill(named("spikeloop-guard"), SIGSTOP);
  child_->signal(SIGINT);
  const auto outcome = child_->wait();
  EXPECT_EQ(outcome.exit_code, 130) << outcome.text();
  EXPECT_EQ(outcome.left_behind, 0) << "a guard that does not end is killed";
}

TEST_F(GuardTest, two_jobs_at_once) {
  ASSERT_NO_FATAL_FAILURE(run_until_it_drives("stoptime=100"));
  robot_.listen_array("/motors");
  Child other(launched(scan_to_motors("stoptime=100"), "other.music"));
  const auto values = [&] { return robot_.arrays(); };
  ASSERT_TRUE(eventually(60, [&] { return values().size() > 3 && values().back()[0] != 0; }))
      << other.output();
  const pid_t adapter = named("ros_command_ada");
  const auto begin = monotonic_now();
  kill(adapter, SIGKILL);
  expect_zero_since(begin, "one of two adapters killed");
  EXPECT_EQ(child_->wait().left_behind, 0);
  const std::size_t before = values().size();
  EXPECT_TRUE(eventually(10, [&] {
    return values().size() > before + 5 && values().back()[0] != 0;
  })) << "the other robot drives on";
  EXPECT_THAT(other.output(), Not(HasSubstr("has died")));
  kill(named("ros_command_ada", other), SIGKILL);
  EXPECT_TRUE(eventually(10, [&] { return values().back()[0] == 0; }));
  EXPECT_EQ(other.wait().left_behind, 0);
}

TEST_F(GuardTest, a_job_by_hand) {
  const std::string socket = (directory_.path() / "guard").string();
  Child guard({.arguments = {binary("spikeloop-guard"), "--socket", socket}});
  ASSERT_TRUE(eventually(10, [&] { return std::filesystem::exists(socket); }));
  publish_scans();
  robot_.listen_twist("/cmd_vel");
  Command job = command(3, scan_to_twist("stoptime=100"));
  job.environment["SPIKELOOP_GUARD"] = socket;
  child_ = std::make_unique<Child>(job);
  ASSERT_TRUE(drives());
  const pid_t adapter = named("ros_command_ada");
  const auto begin = monotonic_now();
  kill(adapter, SIGKILL);
  expect_zero_since(begin, "adapter killed, all started by hand");
  EXPECT_EQ(child_->wait().left_behind, 0);
  guard.signal(SIGINT);
  const auto outcome = guard.wait();
  EXPECT_EQ(outcome.exit_code, 0);
  // On a busy machine it may be silent for long before its end is known.
  EXPECT_THAT(outcome.err,
              testing::EndsWith("spikeloop-guard: warning: the robot on /cmd_vel is stopped: its "
                                "command adapter 'command' has died\n"));
  EXPECT_FALSE(std::filesystem::exists(socket));
}

}  // namespace
