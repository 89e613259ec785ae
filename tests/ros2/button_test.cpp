// An emergency button is heard: the first press of one that was there before, and the only one of a
// program that ends with it, as `ros2 topic pub --once`.
#include <gtest/gtest.h>

#include <memory>
#include <optional>
#include <string>

#include "spikeloop/ros2/session.hpp"
#include "tests/ros2/domain.hpp"
#include "tests/ros2/heard.hpp"
#include "tests/support/child.hpp"

namespace {

using namespace spikeloop;
using test::Child;
using test::eventually;
using test::Heard;

constexpr double kPatience = 30;  // seconds
constexpr double kAtOnce = 2;     // where nothing may wait for the next heartbeat, after three

/// A node that subscribes as a command does.
class Robot {
 public:
  explicit Robot(const test::FreeDomain& domain)
      : session_({.node_name = "robot", .place = {{"ROS_DOMAIN_ID", domain.text()}}}),
        subscriber_(session_.subscriber(heard_.subscription(kTopic, "std_msgs/Bool", 0))) {}

  bool knows_publishers() {
    return eventually(kPatience, [this] { return session_.publishers_are_connected(kTopic); });
  }
  bool has_heard(std::size_t presses, double seconds) {
    return eventually(seconds, [&] { return heard_.count() >= presses; });
  }
  std::size_t heard() const { return heard_.count(); }

 private:
  static constexpr const char* kTopic = "/emergency_stop";

  Heard heard_;
  ros2::Session session_;
  std::unique_ptr<topics::RawSubscriber> subscriber_;
};

/// On Fast DDS or on a node of ours.
class ButtonTest : public testing::TestWithParam<const char*> {
 protected:
  test::FreeDomain domain_;
};

TEST_P(ButtonTest, is_heard_from_its_first_press_by_every_robot_that_comes) {
  Child button({.arguments = {GetParam(), domain_.text(), "stay"}, .environment = domain_.place()});
  ASSERT_TRUE(button.wait_for("ready", std::chrono::seconds(30))) << button.output();
  for (int i = 0; i < 6; ++i) {
    Robot robot(domain_);
    ASSERT_TRUE(robot.knows_publishers());
    button.signal(SIGUSR1);
    ASSERT_TRUE(robot.has_heard(1, kAtOnce)) << "robot " << i;
    button.signal(SIGUSR1);
    ASSERT_TRUE(robot.has_heard(2, kAtOnce)) << "robot " << i;
    EXPECT_EQ(robot.heard(), 2U) << "robot " << i << " has heard what was pressed before it came";
  }
  button.signal(SIGTERM);
  EXPECT_EQ(button.wait().exit_code, 0);
}

INSTANTIATE_TEST_SUITE_P(Buttons, ButtonTest, testing::Values(FASTDDS_BUTTON, ROS2_BUTTON),
                         [](const auto& test) {
                           return std::string(test.index == 0 ? "fast_dds" : "ours");
                         });

/// On a network that loses one packet in four.
TEST(OneMessageTest, is_heard_of_a_program_that_ends_with_it) {
  const test::FreeDomain domain;
  topics::Place lossy = domain.place();
  lossy["CYCLONEDDS_URI"] =
      "<CycloneDDS><Domain><Internal><Test><XmitLossiness>250</XmitLossiness></Test></Internal>"
      "</Domain></CycloneDDS>";  // per mille
  Robot robot(domain);
  for (int press = 1; press <= 20; ++press) {
    const std::size_t before = robot.heard();
    Child button({.arguments = {ROS2_BUTTON, domain.text(), "once"}, .environment = lossy});
    ASSERT_TRUE(robot.has_heard(before + 1, kPatience))
        << "press " << press << ": " << button.output();
    EXPECT_EQ(button.wait().exit_code, 0);
    // Once; perhaps twice, if the program had ended when its message came (ros2::Reader).
    EXPECT_LE(robot.heard(), before + 2);
  }
}

/// `ros2 topic pub --once` on Fast DDS waits for one subscriber, with `-w 2` for two.
TEST(OneMessageTest, is_heard_by_as_many_subscribers_as_the_program_waits_for) {
  const test::FreeDomain domain;
  Robot robot(domain);
  std::optional<Robot> other;
  for (const char* const mode : {"once", "once2"}) {
    const std::size_t before = robot.heard();
    for (std::size_t press = 1; press <= 10; ++press) {
      Child button(
          {.arguments = {FASTDDS_BUTTON, domain.text(), mode}, .environment = domain.place()});
      ASSERT_TRUE(robot.has_heard(before + press, kPatience)) << mode << " " << press;
      if (other) {
        ASSERT_TRUE(other->has_heard(press, kPatience)) << mode << " " << press;
      }
      EXPECT_EQ(button.wait().exit_code, 0);
    }
    other.emplace(domain);
  }
}

}  // namespace
