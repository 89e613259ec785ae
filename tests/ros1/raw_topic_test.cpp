// Topics as bytes, with a real master and roscpp's own generated messages on the other side.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>
#include <mutex>

#include "ros_peer.hpp"
#include "settings.hpp"
#include "spikeloop/core/error.hpp"
#include "tests/support/fault.hpp"
#include "tests/support/roscore.hpp"

namespace {

using spikeloop::test::Fault;
using namespace spikeloop;
using namespace spikeloop::ros1;
using ros_peer::eventually;

std::vector<std::byte> bytes_of(const std::vector<double>& values) {
  std::vector<std::byte> bytes(8 * values.size());
  std::memcpy(bytes.data(), values.data(), bytes.size());
  return bytes;
}

class RawTopicTest : public testing::Test {
 protected:
  std::function<void(std::span<const std::byte>)> keep() {
    return [this](std::span<const std::byte> message) {
      const std::lock_guard lock(mutex_);
      heard_.emplace_back(message.begin(), message.end());
    };
  }
  std::unique_ptr<topics::RawSubscriber> listen(const std::string& topic, const std::string& type) {
    return session_.subscriber({.topic = topic, .message_type = type, .take = keep()});
  }
  std::vector<std::vector<std::byte>> heard() {
    const std::lock_guard lock(mutex_);
    return heard_;
  }

  test::RosCore core_;
  Session session_{test::node_at(core_.uri(), "raw")};
  ros_peer::Peer robot_{core_.uri()};
  std::mutex mutex_;
  std::vector<std::vector<std::byte>> heard_;
};

const std::vector<double> kTwist{0.25, 0, 0, 0, 0, -0.5};

TEST_F(RawTopicTest, sends_bytes) {
  const auto publisher = session_.publisher("/cmd_vel", "geometry_msgs/Twist");
  EXPECT_FALSE(publisher->has_subscribers());
  robot_.listen_twist("/cmd_vel");
  ASSERT_TRUE(eventually(20, [&] { return publisher->has_subscribers(); }));
  publisher->publish(bytes_of(kTwist));
  publisher->drain();
  ASSERT_TRUE(eventually(20, [&] { return !robot_.twists().empty(); }));
  EXPECT_EQ(robot_.twists().front().linear_x, 0.25);
  EXPECT_EQ(robot_.twists().front().angular_z, -0.5);
}

TEST_F(RawTopicTest, a_latched_topic_brings_the_last_message_to_those_that_come_later) {
  const auto publisher = session_.publisher("/cmd_vel", "geometry_msgs/Twist", 10, true);
  publisher->publish(bytes_of({1, 0, 0, 0, 0, 0}));
  publisher->publish(bytes_of(kTwist));
  robot_.listen_twist("/cmd_vel");
  ASSERT_TRUE(eventually(20, [&] { return !robot_.twists().empty(); }));
  EXPECT_EQ(robot_.twists().front().linear_x, 0.25);
}

TEST_F(RawTopicTest, a_latched_publisher_is_known_by_its_messages) {
  const auto publisher = session_.publisher("/in", "Twist", 10, true);
  const auto subscriber = listen("/in", "Twist");
  EXPECT_FALSE(subscriber->latched());
  publisher->publish(bytes_of(kTwist));
  EXPECT_TRUE(eventually(20, [&] { return subscriber->latched(); }));
}

TEST_F(RawTopicTest, receives_bytes) {
  const auto subscriber = listen("/in", "Twist");
  ASSERT_TRUE(eventually(20, [&] {
    robot_.publish_twist("/in", 0.25, -0.5);
    return !heard().empty();
  }));
  EXPECT_EQ(heard().front(), bytes_of(kTwist));
}

TEST_F(RawTopicTest, refuses_another_type) {
  const auto arrays = listen("/in", "std_msgs/Float64MultiArray");
  robot_.publish_twist("/in", 1, 1);
  std::this_thread::sleep_for(std::chrono::seconds(1));
  robot_.publish_twist("/in", 1, 1);
  EXPECT_EQ(robot_.subscribers("/in"), 0);
  EXPECT_TRUE(heard().empty());
}

TEST_F(RawTopicTest, is_silent_after_its_end) {
  auto subscriber = listen("/in", "Twist");
  ASSERT_TRUE(eventually(20, [&] {
    robot_.publish_twist("/in", 1, 1);
    return !heard().empty();
  }));
  subscriber.reset();
  const std::size_t before = heard().size();
  EXPECT_TRUE(eventually(20, [&] {
    robot_.publish_twist("/in", 1, 1);
    return robot_.subscribers("/in") == 0;
  }));
  EXPECT_EQ(heard().size(), before);
}

// The header begins with the number; the rest of a scan of zeros are 52 - 4 bytes.
TEST_F(RawTopicTest, messages_with_a_header_are_numbered) {
  const auto publisher = session_.publisher("/scan", "sensor_msgs/LaserScan");
  const auto subscriber = listen("/scan", "sensor_msgs/LaserScan");
  ASSERT_TRUE(eventually(20, [&] { return publisher->has_subscribers(); }));
  const std::vector<std::byte> scan(52, std::byte{0});
  for (std::size_t i = 0; i < 3; ++i) {
    publisher->publish(scan);
    ASSERT_TRUE(eventually(20, [&] { return heard().size() > i; }));
    auto numbered = scan;
    numbered[0] = static_cast<std::byte>(i);
    EXPECT_EQ(heard()[i], numbered);
  }
}

TEST_F(RawTopicTest, errors) {
  for (const std::string topic : {"", "1a", "a b", "~a"}) {
    const std::string text = "'" + topic + "' ... [SL0501]";
    const auto error_of = [](auto action) -> std::string {
      try {
        action();
      } catch (const ConfigurationError& error) {
        return error.what();
      }
      return "no error";
    };
    EXPECT_THAT(error_of([&] { session_.publisher(topic, "geometry_msgs/Twist"); }), Fault(text));
    EXPECT_THAT(error_of([&] { listen(topic, "geometry_msgs/Twist"); }), Fault(text));
  }
  EXPECT_THROW(session_.publisher("/a", "geometry_msgs/Twits"), ConfigurationError);
  EXPECT_THROW(listen("/a", "geometry_msgs/Twits"), ConfigurationError);
}

}  // namespace
