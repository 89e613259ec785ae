// A robot on Fast DDS, whatever order they start in and wherever they look for each other.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <cstring>
#include <memory>
#include <mutex>
#include <thread>
#include <vector>

#include "spikeloop/core/log.hpp"
#include "spikeloop/ros2/session.hpp"
#include "spikeloop/topics/rosout.hpp"
#include "tests/ros2/domain.hpp"
#include "tests/ros2/heard.hpp"
#include "tests/support/child.hpp"

namespace {

using namespace spikeloop;
using ros2::Session;
using test::Bytes;
using test::Child;
using test::eventually;
using test::Heard;
using testing::HasSubstr;

constexpr double kLong = 30;  // seconds: Fast DDS takes one or two, a killed peer's lease twenty
constexpr auto kLongMilliseconds = std::chrono::milliseconds(30'000);

template <typename Value>
Value value_at(const Bytes& message, std::size_t place) {
  Value value{};
  std::memcpy(&value, message.data() + 4 + place, sizeof value);
  return value;
}

Bytes twist_of(double linear_x, double angular_z) {
  Bytes fields(48);
  std::memcpy(fields.data(), &linear_x, 8);
  std::memcpy(fields.data() + 40, &angular_z, 8);
  return test::message_of(fields);
}

class FastDdsTest : public testing::Test {
 protected:
  std::unique_ptr<Child> robot(const std::string& mode, const std::string& gid_bytes = "") {
    std::vector<std::string> arguments{FASTDDS_PEER, domain_.text(), mode};
    if (!gid_bytes.empty()) {
      arguments.push_back(gid_bytes);
    }
    return start(arguments);
  }
  std::unique_ptr<Child> start(const std::vector<std::string>& arguments) {
    // Only nodes of ours read it.
    auto child = std::make_unique<Child>(
        test::Command{.arguments = arguments, .environment = domain_.place()});
    EXPECT_TRUE(child->wait_for("ready", kLongMilliseconds)) << child->output();
    return child;
  }
  Session& start_brain(topics::Place place) {
    place["ROS_DOMAIN_ID"] = domain_.text();
    brain_ = std::make_unique<Session>(
        topics::SessionSettings{.node_name = "brain", .place = std::move(place)});
    scan_ = brain_->subscriber(heard_.subscription("/scan", "sensor_msgs/LaserScan", 1));
    command_ = brain_->publisher("/cmd_vel", "geometry_msgs/Twist");
    return *brain_;
  }
  /// Scans come, and a command of this speed gets there.
  void expect_a_loop_with(Child& robot, double speed) {
    const std::size_t before = heard_.count();
    EXPECT_TRUE(eventually(kLong, [&] { return heard_.count() > before + 2; }));
    const std::string words = fmt::format("twist {:g} -0.5", speed);
    EXPECT_TRUE(eventually(kLong, [&] {
      command_->publish(twist_of(speed, -0.5));
      return robot.wait_for(words, std::chrono::milliseconds(50));
    })) << robot.output();
  }

  test::FreeDomain domain_;
  Heard heard_;
  std::unique_ptr<Session> brain_;
  std::unique_ptr<topics::RawSubscriber> scan_;
  std::unique_ptr<topics::RawPublisher> command_;
};

TEST_F(FastDdsTest, brings_every_byte_of_a_scan) {
  start_brain({});
  const auto other = robot("udp");
  ASSERT_TRUE(eventually(kLong, [&] { return heard_.count() > 0; }));
  const Bytes scan = heard_.messages().front();
  // sec, nanosec, "laser" with its length and NUL, fill, seven floats, three ranges, no
  // intensities.
  ASSERT_EQ(scan.size(), 4U + 8 + 4 + 6 + 2 + 28 + 4 + 12 + 4);
  EXPECT_EQ(value_at<std::uint32_t>(scan, 8), 6U);
  EXPECT_EQ(value_at<char>(scan, 12), 'l');
  EXPECT_EQ(value_at<float>(scan, 44), 8.0F);
  EXPECT_EQ(value_at<std::uint32_t>(scan, 48), 3U);
  EXPECT_EQ(value_at<float>(scan, 60), 2.5F);
  expect_a_loop_with(*other, 0.25);
}

TEST_F(FastDdsTest, counts_what_it_was_too_slow_for) {
  Session session({.node_name = "brain", .place = domain_.place()});
  std::mutex mutex;
  std::vector<std::uint32_t> numbers;  // of the scans that came
  std::atomic<topics::RawSubscriber*> counting = nullptr;
  bool first = true;
  std::atomic<std::uint64_t> before = 0;  // lost before the first that came
  const auto slow = session.subscriber(
      {.topic = "/scan",
       .message_type = "sensor_msgs/LaserScan",
       .queue = 1,
       .take = [&](std::span<const std::byte> message) {
         if (first) {
           before = *counting.load()->lost();
           first = false;
         }
         std::this_thread::sleep_for(std::chrono::milliseconds(170));
         const std::lock_guard lock(mutex);
         numbers.push_back(value_at<std::uint32_t>(Bytes(message.begin(), message.end()), 0));
       }});
  counting = slow.get();
  EXPECT_EQ(slow->lost(), 0U);
  const auto other = robot("udp");  // twenty scans a second
  EXPECT_TRUE(eventually(kLong, [&] { return slow->lost() > 10U; }));
  other->signal(SIGTERM);
  other->wait();
  EXPECT_TRUE(eventually(kLong,
                         [&] {
                           const std::lock_guard lock(mutex);
                           return *slow->lost() - before + numbers.size() ==
                                  numbers.back() - numbers.front() + 1;
                         }))
      << *slow->lost() << " lost, " << before << " of them before the first, " << numbers.size()
      << " taken, " << numbers.front() << " to " << numbers.back();
}

TEST_F(FastDdsTest, gets_what_was_latched_before) {
  Session session({.node_name = "brain", .place = domain_.place()});
  const auto latched = session.publisher("/cmd_vel", "geometry_msgs/Twist", 1, true);
  latched->publish(twist_of(0.125, 0));
  latched->publish(twist_of(0.25, -0.5));
  const auto other = robot("latched");
  EXPECT_TRUE(other->wait_for("twist 0.25 -0.5", kLongMilliseconds)) << other->output();
  EXPECT_EQ(other->output().find("0.125"), std::string::npos);
}

TEST_F(FastDdsTest, confirms_a_command_within_milliseconds) {
  Session session({.node_name = "brain", .place = domain_.place()});
  const auto commands = session.publisher("/cmd_vel", "geometry_msgs/Twist");
  const auto other = robot("udp");
  ASSERT_TRUE(eventually(kLong, [&] { return commands->has_subscribers(); }));
  ASSERT_TRUE(eventually(kLong, [&] { return commands->deliver(); }));
  const auto begin = std::chrono::steady_clock::now();
  constexpr int kCommands = 50;
  for (int i = 1; i <= kCommands; ++i) {
    commands->publish(twist_of(i, 0));
    ASSERT_TRUE(eventually(kLong, [&] { return commands->deliver(); })) << i;
  }
  const auto time = std::chrono::steady_clock::now() - begin;
  EXPECT_LT(time, kCommands * std::chrono::milliseconds(80)) << "it waits for the next heartbeat";
  EXPECT_TRUE(other->wait_for("twist 50 0", kLongMilliseconds));
}

/// A mode of the robot, and what its subscriber of commands requests.
struct Misfit {
  const char* mode;
  const char* text;
};
class MisfitTest : public FastDdsTest, public testing::WithParamInterface<Misfit> {};

TEST_P(MisfitTest, is_reported_to_the_publisher) {
  Session session({.node_name = "brain", .place = domain_.place()});
  const auto commands = session.publisher("/cmd_vel", "geometry_msgs/Twist");
  EXPECT_EQ(commands->misfit(), "");
  {
    const auto other = robot(GetParam().mode);
    EXPECT_TRUE(eventually(kLong, [&] { return commands->misfit() == GetParam().text; }))
        << commands->misfit();
    EXPECT_FALSE(commands->has_subscribers());
    other->signal(SIGTERM);
    other->wait();
  }
  EXPECT_TRUE(eventually(kLong, [&] { return commands->misfit().empty(); }));
}
INSTANTIATE_TEST_SUITE_P(
    Policies, MisfitTest,
    testing::Values(
        Misfit{"latched", "durability transient local, but Spikeloop's publisher is volatile"},
        Misfit{"deadline", "a deadline of 100 ms, but Spikeloop's publisher has none"},
        Misfit{"liveliness", "liveliness by topic, but that of Spikeloop's publisher is automatic"},
        Misfit{"lease", "a liveliness lease of 1 s, but Spikeloop's publisher has none"}),
    [](const auto& test) { return std::string(test.param.mode); });

TEST_F(FastDdsTest, brings_a_scan_that_was_latched_before) {
  const auto other = robot("one-scan");
  Session session({.node_name = "brain", .place = domain_.place()});
  for (const std::uint32_t queue : {0U, 1U, 10U}) {
    Heard heard;
    auto subscription = heard.subscription("/scan", "sensor_msgs/LaserScan", queue);
    subscription.latched = true;
    const auto scans = session.subscriber(subscription);
    ASSERT_TRUE(eventually(kLong, [&] { return heard.count() > 0; })) << "queue " << queue;
    EXPECT_EQ(value_at<std::int32_t>(heard.messages()[0], 0), 0);
  }
}

TEST_F(FastDdsTest, gets_what_was_logged_before) {
  Session session({.node_name = "brain", .place = domain_.place()});
  const topics::Rosout rosout(session);
  log::warning("no subscriber");
  const auto other = robot("udp");
  EXPECT_TRUE(other->wait_for("log 30 brain: no subscriber\n", kLongMilliseconds))
      << other->output();
}

/// Of publishers of both kinds.
class EveryMessageTest : public FastDdsTest, public testing::WithParamInterface<const char*> {};

TEST_P(EveryMessageTest, comes_once) {
  Session session({.node_name = "brain", .place = domain_.place()});
  Heard heard;
  const auto scans = session.subscriber(heard.subscription("/scan", "sensor_msgs/LaserScan", 0));
  const auto other = robot(GetParam());
  ASSERT_TRUE(eventually(kLong, [&] { return heard.count() >= 20; }));
  const std::vector<Bytes> messages = heard.messages();
  const auto first = value_at<std::int32_t>(messages.front(), 0);
  for (std::size_t i = 0; i < messages.size(); ++i) {
    ASSERT_EQ(value_at<std::int32_t>(messages[i], 0), first + static_cast<int>(i));
  }
}
INSTANTIATE_TEST_SUITE_P(Publishers, EveryMessageTest, testing::Values("udp", "best-effort"));

/// On Fast DDS or on a node of ours.
class RobotTest : public FastDdsTest, public testing::WithParamInterface<const char*> {
 protected:
  std::unique_ptr<Child> any_robot() { return start({GetParam(), domain_.text(), "udp"}); }
};

TEST_P(RobotTest, may_have_been_there_before_be_killed_and_come_again) {
  auto other = any_robot();
  start_brain(domain_.place());
  expect_a_loop_with(*other, 0.25);
  other->signal(SIGKILL);
  other->wait();
  other = any_robot();
  expect_a_loop_with(*other, 0.5);
}

TEST_P(RobotTest, may_come_later_be_killed_and_come_again) {
  start_brain(domain_.place());
  auto other = any_robot();
  expect_a_loop_with(*other, 0.25);
  other->signal(SIGKILL);
  other->wait();
  other = any_robot();
  expect_a_loop_with(*other, 0.5);
}

TEST_P(RobotTest, meets_a_brain_that_comes_again) {
  const auto other = any_robot();
  for (const double speed : {0.25, 0.5}) {
    start_brain(domain_.place());
    expect_a_loop_with(*other, speed);
    scan_.reset();
    command_.reset();
    brain_.reset();
  }
}

INSTANTIATE_TEST_SUITE_P(Peers, RobotTest, testing::Values(FASTDDS_PEER, ROS2_PEER),
                         [](const auto& test) {
                           return std::string(test.index == 0 ? "fast_dds" : "ours");
                         });

struct Meeting {
  std::string robot;
  std::string range;
};

class FastDdsMeetingTest : public FastDdsTest, public testing::WithParamInterface<Meeting> {};

TEST_P(FastDdsMeetingTest, robot_first) {
  const auto other = robot(GetParam().robot);
  start_brain({{"ROS_AUTOMATIC_DISCOVERY_RANGE", GetParam().range}});
  expect_a_loop_with(*other, 0.25);
  other->signal(SIGTERM);
  EXPECT_EQ(other->wait().exit_code, 0);
}

TEST_P(FastDdsMeetingTest, brain_first) {
  start_brain({{"ROS_AUTOMATIC_DISCOVERY_RANGE", GetParam().range}});
  const auto other = robot(GetParam().robot);
  expect_a_loop_with(*other, 0.25);
  other->signal(SIGTERM);
  EXPECT_EQ(other->wait().exit_code, 0);
}

INSTANTIATE_TEST_SUITE_P(
    Everywhere, FastDdsMeetingTest,
    testing::Values(Meeting{"subnet", "SUBNET"}, Meeting{"localhost", "SUBNET"},
                    Meeting{"localhost-only", "SUBNET"}, Meeting{"localhost", "LOCALHOST"},
                    Meeting{"localhost-only", "LOCALHOST"}, Meeting{"subnet", "LOCALHOST"}),
    [](const auto& test) {
      std::string name = test.param.robot + "_with_" + test.param.range;
      std::replace(name.begin(), name.end(), '-', '_');
      return name;
    });

/// Not when its lease ends, after 10 s.
TEST_F(FastDdsTest, sees_at_once_that_a_brain_has_left) {
  start_brain(domain_.place());
  const auto other = robot("udp");
  ASSERT_TRUE(other->wait_for("publishers 1", kLongMilliseconds)) << other->output();
  scan_.reset();
  command_.reset();
  brain_.reset();
  EXPECT_TRUE(other->wait_for("publishers 0", std::chrono::seconds(5))) << other->output();
}

/// As a process does that has no time to end.
TEST_F(FastDdsTest, sees_at_once_that_a_brain_takes_leave) {
  start_brain(domain_.place());
  const auto other = robot("udp");
  ASSERT_TRUE(other->wait_for("publishers 1", kLongMilliseconds)) << other->output();
  brain_->leave();
  EXPECT_TRUE(other->wait_for("publishers 0", std::chrono::seconds(5))) << other->output();
}

TEST_F(FastDdsTest, is_not_met_by_a_brain_that_is_off) {
  start_brain({{"ROS_AUTOMATIC_DISCOVERY_RANGE", "OFF"}});
  const auto other = robot("udp");
  EXPECT_FALSE(eventually(3, [&] { return heard_.count() > 0 || scan_->has_publishers(); }));
}

TEST_F(FastDdsTest, meets_a_brain_of_the_systems_default) {
  start_brain({{"ROS_AUTOMATIC_DISCOVERY_RANGE", "SYSTEM_DEFAULT"}});
  const auto other = robot("subnet");
  expect_a_loop_with(*other, 0.25);
  other->signal(SIGTERM);
  other->wait();
}

TEST_F(FastDdsTest, sees_our_node_in_the_length_of_its_own) {
  for (const char* gid_bytes : {"16", "24"}) {
    const auto other = robot("udp", gid_bytes);
    start_brain({});
    EXPECT_TRUE(other->wait_for("node / brain readers 1 writers 1\n", kLongMilliseconds))
        << other->output();
    scan_.reset();
    EXPECT_TRUE(other->wait_for("node / brain readers 0 writers 1\n", kLongMilliseconds))
        << other->output();
    EXPECT_FALSE(other->wait_for("cannot read", std::chrono::milliseconds(100)));
    command_.reset();
    brain_.reset();
  }
}

TEST_F(FastDdsTest, sees_no_node_of_another_length) {
  start_brain({{"ROS_DISTRO", "humble"}});
  const auto other = robot("udp", "16");
  expect_a_loop_with(*other, 0.25);
  EXPECT_FALSE(other->wait_for("node ", std::chrono::milliseconds(500))) << other->output();
}

}  // namespace
