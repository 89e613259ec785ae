// The command that stops a robot: positions are held, velocities and efforts are 0.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "spikeloop/command/command_channel.hpp"
#include "spikeloop/command/mapping.hpp"

namespace spikeloop::command::stop_test {
namespace {

using testing::ElementsAre;
using testing::IsNan;

constexpr TimeNs kMs = 1'000'000;
const double kNan = std::nan("");

/// A position, held as that of joint `elbow`, and a velocity.
class StopTest : public testing::Test {
 protected:
  using Values = std::vector<double>;

  static CommandSettings settings() {
    return {.gate = {.deadband = {0, 0}, .period = 50 * kMs},
            .stops = {{.hold = true, .joint = "elbow"}, {}}};
  }
  static Values values(double position, double velocity) { return {position, velocity}; }
  void command(double position, double velocity, TimeNs now) {
    channel_.command(values(position, velocity), now);
  }
  void measure(double position, TimeNs now) { channel_.measure(values(position, kNan), now); }

  std::vector<Values> sent_;
  CommandChannel channel_{settings(),
                          [this](auto sent) { sent_.emplace_back(sent.begin(), sent.end()); }};
};

TEST_F(StopTest, holds_the_measured_position) {
  measure(0.2, 0);
  command(1, 3, 0);
  measure(0.4, 10 * kMs);
  channel_.stop(StopReason::sensor_silent, 20 * kMs);
  EXPECT_THAT(sent_, ElementsAre(values(1, 3), values(0.4, 0)));
}

TEST_F(StopTest, repeats_one_position_though_the_joint_yields) {
  command(1, 3, 0);
  measure(0.4, 10 * kMs);
  channel_.stop(StopReason::sensor_silent, 20 * kMs);
  measure(0.3, 60 * kMs);
  channel_.poll(80 * kMs);
  channel_.stop(StopReason::emergency, 90 * kMs);
  channel_.stop(StopReason::ended, 100 * kMs);
  EXPECT_THAT(sent_, ElementsAre(values(1, 3), values(0.4, 0), values(0.4, 0), values(0.4, 0),
                                 values(0.4, 0)));
}

TEST_F(StopTest, holds_the_last_command_without_a_fresh_measurement) {
  command(1, 3, 0);
  channel_.stop(StopReason::sensor_silent, 20 * kMs);
  EXPECT_THAT(sent_.back(), values(1, 0));
  measure(0.4, 30 * kMs);
  command(2, 3, 40 * kMs);
  channel_.stop(StopReason::sensor_silent, 31 * kMs + kMeasuredAge);
  EXPECT_THAT(sent_.back(), values(2, 0)) << "the measurement is too old";
}

TEST_F(StopTest, a_joint_that_is_no_longer_reported_is_not_kept_alive_by_others) {
  command(1, 3, 0);
  measure(0.4, 10 * kMs);
  measure(kNan, 11 * kMs + kMeasuredAge);
  channel_.stop(StopReason::sensor_silent, 11 * kMs + kMeasuredAge);
  EXPECT_EQ(sent_.back(), values(1, 0));
}

TEST_F(StopTest, commands_no_position_before_one_is_known) {
  channel_.hold(StopReason::emergency, 0);
  EXPECT_THAT(sent_, ElementsAre(ElementsAre(IsNan(), 0)));
  channel_.hold(std::nullopt, 10 * kMs);
  command(1, 3, 20 * kMs);
  EXPECT_EQ(sent_.back(), values(1, 3));
}

TEST_F(StopTest, sends_nothing_to_an_arm_whose_position_is_not_known) {
  std::size_t sent = 0;
  CommandChannel arm({.gate = {.deadband = {0}}, .stops = {{.hold = true}}}, [&](auto) { ++sent; });
  arm.stop(StopReason::ended, 0);
  EXPECT_EQ(sent, 0U);
}

TEST_F(StopTest, the_guard_sends_what_a_stop_would_send) {
  EXPECT_THAT(channel_.stop_values(0), ElementsAre(IsNan(), 0));
  command(1, 3, 0);
  EXPECT_EQ(channel_.stop_values(0), values(1, 0));
  measure(0.4, 10 * kMs);
  EXPECT_EQ(channel_.stop_values(20 * kMs), values(0.4, 0));
  channel_.stop(StopReason::ended, 20 * kMs);
  measure(0.3, 30 * kMs);
  EXPECT_EQ(channel_.stop_values(40 * kMs), values(0.4, 0)) << "this stop lasts";
}

TEST_F(StopTest, the_way_back_starts_where_the_joint_is_held) {
  CommandSettings slow = settings();
  slow.bounds = {{.slew = 1}, {.slew = 1}};
  CommandChannel arm(slow, [this](auto sent) { sent_.emplace_back(sent.begin(), sent.end()); });
  arm.measure(values(0.4, kNan), 0);
  arm.stop(StopReason::emergency, 0);
  arm.command(values(1, 1), 2000 * kMs);
  arm.command(values(1, 1), 2100 * kMs);
  EXPECT_THAT(sent_.back(), ElementsAre(testing::DoubleEq(0.5), testing::DoubleEq(0.1)));
}

TEST_F(StopTest, the_first_way_starts_where_the_joint_is_measured) {
  CommandSettings slow = settings();
  slow.bounds = {{.slew = 1}, {.slew = 1}};
  CommandChannel arm(slow, [this](auto sent) { sent_.emplace_back(sent.begin(), sent.end()); });
  arm.stop(StopReason::no_value, 0);
  arm.measure(values(0.4, kNan), 1000 * kMs);
  arm.command(values(1, 1), 1010 * kMs);
  arm.command(values(1, 1), 1110 * kMs);
  EXPECT_THAT(sent_.back(), ElementsAre(testing::DoubleEq(0.5), testing::DoubleEq(0.1)));
}

TEST_F(StopTest, a_field_may_have_a_value_of_its_own) {
  std::vector<double> sent;
  CommandChannel drone({.gate = {.deadband = {0}}, .stops = {{.value = 0.5}}},
                       [&](auto values) { sent.push_back(values[0]); });
  drone.command(std::vector<double>{0.9}, 0);
  drone.stop(StopReason::terminated, kMs);
  EXPECT_THAT(sent, ElementsAre(0.9, 0.5));
}

StopRule rule_of(const std::string& type, const std::string& field) {
  return stop_rules({.file = "", .message_type = type, .fields = {{.field = field}}}, 1).front();
}

TEST(StopRules, positions_are_held_and_all_else_is_zero) {
  const std::string joints = "sensor_msgs/JointState";
  EXPECT_EQ(rule_of(joints, "position[name=arm.elbow]"), (StopRule{true, "arm.elbow"}));
  EXPECT_EQ(rule_of(joints, "position[2]"), (StopRule{true}));
  EXPECT_EQ(rule_of(joints, "velocity[name=position]"), StopRule{});
  EXPECT_EQ(rule_of(joints, "effort[name=elbow]"), StopRule{});
  EXPECT_EQ(rule_of("trajectory_msgs/JointTrajectory", "points[0].positions[1]"), (StopRule{true}));
  EXPECT_EQ(rule_of("trajectory_msgs/JointTrajectory", "points[0].velocities[1]"), StopRule{});
  EXPECT_EQ(rule_of("geometry_msgs/PoseStamped", "pose.orientation.w"), (StopRule{true}));
  EXPECT_EQ(rule_of("geometry_msgs/Pose2D", "theta"), (StopRule{true}));
  EXPECT_EQ(rule_of("geometry_msgs/Twist", "linear.x"), StopRule{});
  EXPECT_EQ(rule_of("std_msgs/Float64MultiArray", "data[0]"), StopRule{});
}

TEST(StopRules, the_mapping_has_priority) {
  const auto mapping = parse_mapping(
      R"({"message_type": "sensor_msgs/JointState", "stop": "hold", "mapping": {
          "position[name=a]": {"channel": 0, "stop": 0.5},
          "velocity[name=b]": {"channel": 1},
          "position[name=c]": {"channel": 2, "stop": "hold elbow"},
          "position[name=d]": {"channel": 3},
          "effort[name=e]": {"channel": 4, "stop": "hold"}}})",
      "map.json");
  // A velocity or an effort that is held would not stop the robot.
  EXPECT_THAT(stop_rules(mapping, 5),
              ElementsAre(StopRule{.value = 0.5}, StopRule{}, StopRule{true, "elbow"},
                          StopRule{true, "d"}, StopRule{}));
  const auto all = parse_mapping(R"({"message_type": "Float64MultiArray", "stop": "hold"})", "");
  EXPECT_THAT(stop_rules(all, 2), ElementsAre(StopRule{true}, StopRule{true}));
}

}  // namespace
}  // namespace spikeloop::command::stop_test
