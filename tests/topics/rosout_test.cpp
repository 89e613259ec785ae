// What a node logs, on /rosout.
#include "spikeloop/topics/rosout.hpp"

#include <gtest/gtest.h>

#include <ctime>
#include <stdexcept>

#include "spikeloop/core/log.hpp"
#include "spikeloop/ros2/session.hpp"
#include "tests/ros1/settings.hpp"
#include "tests/ros2/domain.hpp"
#include "tests/ros2/log_lines.hpp"
#include "tests/support/child.hpp"
#include "tests/support/roscore.hpp"
#include "tests/support/temporary_directory.hpp"

namespace {

using namespace spikeloop;
using test::eventually;

constexpr double kLongWait = 30;  // seconds
constexpr int kWarning = 30;      // of rcl_interfaces/Log
constexpr int kError = 40;

class RosoutTest : public testing::Test {
 protected:
  ~RosoutTest() override { log::set_sink({}); }

  const test::FreeDomain domain_;
  ros2::Session brain_{
      {.node_name = "brain", .arguments = {{"__ns", "/arena"}}, .place = domain_.place()}};
  ros2::Session console_{{.node_name = "console", .place = domain_.place()}};
};

TEST_F(RosoutTest, is_there_for_those_who_come_later) {
  const std::time_t before = std::time(nullptr);
  topics::Rosout rosout(brain_);
  log::warning("no subscriber");
  EXPECT_THROW(rosout.during([] { throw std::runtime_error("the robot has gone"); }),
               std::runtime_error);
  const test::LogLines console(console_);
  EXPECT_TRUE(eventually(kLongWait, [&] {
    return console.has(kWarning, "arena.brain", "no subscriber") &&
           console.has(kError, "arena.brain", "the robot has gone");
  }));
  for (const test::LogLine& line : console.lines()) {
    EXPECT_GE(line.seconds, before);
    EXPECT_LE(line.seconds, std::time(nullptr));
  }
}

TEST_F(RosoutTest, has_a_bounded_rate) {
  const test::LogLines console(console_);
  topics::Rosout rosout(brain_);
  for (int i = 0; i < 1000; ++i) {
    log::warning("again");
  }
  rosout.error("the end");
  EXPECT_TRUE(eventually(kLongWait, [&] { return console.has(kError, "arena.brain", "the end"); }));
  // A slow machine takes more than a second for them.
  EXPECT_LT(console.lines().size(), 500U);
  EXPECT_TRUE(console.has(kWarning, "arena.brain", "messages before this one are not on /rosout"));
}

TEST_F(RosoutTest, gets_what_is_logged_last) {
  const test::LogLines console(console_);
  ASSERT_TRUE(eventually(kLongWait, [&] {
    // The console may know the publisher only after its end.
    topics::Rosout rosout(brain_);
    log::warning("goodbye");
    eventually(1, [&] { return console.has(kWarning, "arena.brain", "goodbye"); });
    return !console.lines().empty();
  }));
}

/// The node `rosout` of ROS 1, which writes what it hears into a file.
TEST(RosoutOfRos1, is_heard_by_its_node) {
  const test::RosCore core;
  const test::TemporaryDirectory folder;
  const test::Child console({.arguments = {"/usr/lib/rosout/rosout"},
                             .environment = {{"ROS_MASTER_URI", core.uri()},
                                             {"ROS_HOSTNAME", "localhost"},
                                             {"ROS_LOG_DIR", folder.path().string()}}});
  ros1::Session session(test::node_at(core.uri(), "brain"));
  topics::Rosout rosout(session);
  EXPECT_TRUE(eventually(kLongWait, [&] {
    log::warning("no subscriber");
    const std::string lines = folder.read("rosout.log");
    return lines.find(" WARN " + session.node_name()) != std::string::npos &&
           lines.find("no subscriber") != std::string::npos;
  })) << folder.read("rosout.log");
  rosout.error("the robot has gone");
  EXPECT_TRUE(eventually(kLongWait, [&] {
    const std::string lines = folder.read("rosout.log");
    return lines.find(" ERROR " + session.node_name()) != std::string::npos &&
           lines.find("the robot has gone") != std::string::npos;
  })) << folder.read("rosout.log");
}

}  // namespace
