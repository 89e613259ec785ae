// The page by which command adapters know whether the launcher supervises them.
#include "spikeloop/status/supervision.hpp"

#include <gtest/gtest.h>
#include <stdlib.h>
#include <sys/stat.h>

#include <filesystem>

#include "spikeloop/core/error.hpp"
#include "spikeloop/core/pacer.hpp"
#include "tests/support/temporary_directory.hpp"

namespace spikeloop::status {
namespace {

using State = SupervisedRobot::State;
constexpr TimeNs kDeadline = 200'000'000;

class SupervisionTest : public testing::Test {
 protected:
  SupervisionTest() { ::setenv(kSupervisionVariable, path_.c_str(), 1); }
  ~SupervisionTest() override { ::unsetenv(kSupervisionVariable); }

  test::TemporaryDirectory directory_;
  std::string path_ = (directory_.path() / "supervision").string();
};

TEST_F(SupervisionTest, a_launcher_without_beats_is_silent_after_the_deadline) {
  Supervision launcher(path_);
  const SupervisedRobot robot;
  const TimeNs now = wall_now();
  EXPECT_EQ(robot.state(now, kDeadline), State::supervised) << "the page begins fresh";
  launcher.beat(now);
  EXPECT_EQ(robot.state(now + kDeadline, kDeadline), State::supervised);
  EXPECT_EQ(robot.state(now + kDeadline + 1, kDeadline), State::silent);
  launcher.beat(now + kDeadline);
  EXPECT_EQ(robot.state(now + kDeadline + 1, kDeadline), State::supervised);
}

TEST_F(SupervisionTest, a_suspended_launcher_needs_no_deadline) {
  Supervision launcher(path_);
  const SupervisedRobot robot;
  launcher.suspend(true);
  EXPECT_EQ(robot.state(wall_now(), kDeadline), State::suspended);
  launcher.suspend(false);
  EXPECT_EQ(robot.state(wall_now(), kDeadline), State::supervised);
}

TEST_F(SupervisionTest, only_the_adapter_releases_a_robot) {
  const Supervision launcher(path_);
  SupervisedRobot first;
  {
    SupervisedRobot second;
    EXPECT_EQ(launcher.robots(), 2);
    second.release();
    second.release();
    EXPECT_EQ(launcher.robots(), 1) << "once";
  }
  { const SupervisedRobot killed; }
  EXPECT_EQ(launcher.robots(), 2);
}

TEST_F(SupervisionTest, without_a_launcher_every_robot_counts_as_supervised) {
  SupervisedRobot other_host;  // the file does not exist there
  EXPECT_EQ(other_host.state(kNever, 0), State::supervised);
  other_host.release();
  ::unsetenv(kSupervisionVariable);
  EXPECT_EQ(SupervisedRobot().state(kNever, 0), State::supervised);
  directory_.write("supervision", "short");
  ::setenv(kSupervisionVariable, path_.c_str(), 1);
  EXPECT_EQ(SupervisedRobot().state(kNever, 0), State::supervised);
}

TEST_F(SupervisionTest, file_is_private_and_must_not_exist) {
  { const Supervision launcher(path_); }
  struct stat status {};
  ASSERT_EQ(::stat(path_.c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 0777, 0600u);
  EXPECT_THROW(Supervision{path_}, FileError);
}

}  // namespace
}  // namespace spikeloop::status
