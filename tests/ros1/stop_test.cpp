// Whatever dies, the robot gets a zero command. These are safety deadlines: they may be asserted.
#include <cstdio>

#include "robot_job.hpp"

namespace {

using namespace spikeloop::test;
using ros_peer::eventually;
using ros_peer::Twist;

class StopTest : public RobotJob {
 protected:
  void expect_zero_since(std::int64_t begin, const char* what) {
    const double ms = time_to_zero(begin, 10);
    std::printf("%s: zero command after %.1f ms\n", what, ms);
    EXPECT_LE(ms, deadline_.since(begin)) << what;
    const auto outcome = child_->wait();
    EXPECT_EQ(outcome.left_behind, 0) << what;
    EXPECT_TRUE(eventually(2, [&] { return robot_.twists().back().is_zero(); })) << what << "\n"
                                                                                 << outcome.text();
    const auto after = begin + static_cast<std::int64_t>(ms * 1e6);
    for (const Twist& twist : robot_.twists()) {
      EXPECT_TRUE(twist.time_ns < after || twist.is_zero()) << what << ": driven again";
    }
  }

  void run_until_it_drives(const std::string& global, const std::string& keys = "") {
    publish_scans();
    start(scan_to_twist(global, keys));
    ASSERT_TRUE(drives());
  }
};

TEST_F(StopTest, partner_killed) {
  ASSERT_NO_FATAL_FAILURE(run_until_it_drives("stoptime=100"));
  const pid_t partner = process("spikeloop-node");
  ASSERT_GT(partner, 0);
  const auto begin = ros_peer::monotonic_now();
  kill(partner, SIGKILL);
  expect_zero_since(begin, "partner killed");
}

TEST_F(StopTest, partner_stops_without_dying) {
  ASSERT_NO_FATAL_FAILURE(run_until_it_drives("stoptime=100"));
  const pid_t partner = process("spikeloop-node");
  ASSERT_GT(partner, 0);
  const auto begin = ros_peer::monotonic_now();
  kill(partner, SIGSTOP);
  const double ms = time_to_zero(begin, 10);
  EXPECT_LE(ms, deadline_.since(begin));
  const std::size_t before = robot_.twists().size();
  std::this_thread::sleep_for(std::chrono::milliseconds(400));
  EXPECT_GT(robot_.twists().size(), before) << "zeros are repeated while the loop is silent";
  EXPECT_TRUE(robot_.twists().back().is_zero());
  kill(partner, SIGCONT);
  EXPECT_TRUE(eventually(20, [&] { return !robot_.twists().back().is_zero(); }))
      << "commands resume with the ticks";
  child_->signal(SIGUSR1);
  child_->wait();
}

TEST_F(StopTest, mpirun_killed) {
  ASSERT_NO_FATAL_FAILURE(run_until_it_drives("stoptime=100"));
  const auto begin = ros_peer::monotonic_now();
  child_->signal(SIGKILL);
  expect_zero_since(begin, "mpirun killed");
}

TEST_F(StopTest, sigterm_to_mpirun) {
  ASSERT_NO_FATAL_FAILURE(run_until_it_drives("stoptime=100"));
  const auto begin = ros_peer::monotonic_now();
  child_->signal(SIGTERM);
  expect_zero_since(begin, "SIGTERM to mpirun");
}

TEST_F(StopTest, sigint_to_mpirun) {
  ASSERT_NO_FATAL_FAILURE(run_until_it_drives("stoptime=100"));
  const auto begin = ros_peer::monotonic_now();
  child_->signal(SIGINT);
  expect_zero_since(begin, "SIGINT to mpirun");
}

TEST_F(StopTest, clean_stop) {
  ASSERT_NO_FATAL_FAILURE(run_until_it_drives("stoptime=100"));
  const auto begin = ros_peer::monotonic_now();
  child_->signal(SIGUSR1);
  expect_zero_since(begin, "SIGUSR1 to mpirun");
  const auto outcome = child_->wait();
  EXPECT_EQ(outcome.exit_code, 0) << outcome.text();
  EXPECT_EQ(outcome.left_behind, 0);
}

TEST_F(StopTest, clean_stop_while_a_partner_is_waited_for) {
  ASSERT_NO_FATAL_FAILURE(run_until_it_drives("stoptime=100", "watchdog=30"));
  const pid_t partner = process("spikeloop-node");
  ASSERT_GT(partner, 0);
  kill(partner, SIGSTOP);
  const auto begin = ros_peer::monotonic_now();
  child_->signal(SIGUSR1);
  EXPECT_LE(time_to_zero(begin, 10), deadline_.since(begin));
  kill(partner, SIGCONT);
  EXPECT_EQ(child_->wait().exit_code, 0);
}

TEST_F(StopTest, normal_end) {
  ASSERT_NO_FATAL_FAILURE(run_until_it_drives("stoptime=2"));
  const auto outcome = child_->wait();
  EXPECT_EQ(outcome.exit_code, 0) << outcome.text();
  ASSERT_TRUE(eventually(5, [&] { return robot_.twists().back().is_zero(); }));
  const auto twists = robot_.twists();
  const Twist* driving = nullptr;
  for (const Twist& twist : twists) {
    driving = twist.is_zero() ? driving : &twist;
  }
  ASSERT_NE(driving, nullptr);
  const double ms = time_to_zero(driving->time_ns, 1);
  std::printf("normal end: zero command %.1f ms after the last command\n", ms);
  EXPECT_LE(ms, deadline_.since(driving->time_ns));
}

TEST_F(StopTest, data_too_old) {
  ASSERT_NO_FATAL_FAILURE(run_until_it_drives("stoptime=100", "max_age=0.4"));
  stop_publishing();
  const auto begin = ros_peer::monotonic_now();
  const double ms = time_to_zero(begin, 20);
  EXPECT_LE(ms, 400 + deadline_.since(begin));
  EXPECT_TRUE(child_->wait_for("max_age", std::chrono::seconds(60))) << child_->output();
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  EXPECT_TRUE(robot_.twists().back().is_zero());
  publish_scans();
  EXPECT_TRUE(eventually(20, [&] { return !robot_.twists().back().is_zero(); }));
  child_->signal(SIGUSR1);
  child_->wait();
}

}  // namespace
