// Topics as bytes, with a real master and roscpp's own generated messages on the other side.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>
#include <mutex>

#include "ros_peer.hpp"
#include "spikeloop/core/error.hpp"
#include "spikeloop/ros1/raw_publisher.hpp"
#include "spikeloop/ros1/raw_subscriber.hpp"
#include "tests/support/roscore.hpp"

namespace {

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
  RawSubscriber::Callback keep() {
    return [this](std::span<const std::byte> message) {
      const std::lock_guard lock(mutex_);
      heard_.emplace_back(message.begin(), message.end());
    };
  }
  std::vector<std::vector<std::byte>> heard() {
    const std::lock_guard lock(mutex_);
    return heard_;
  }

  test::RosCore core_;
  Session session_{{.node_name = "raw", .unique_name = true, .master_uri = core_.uri()}};
  ros_peer::Peer robot_{core_.uri()};
  std::mutex mutex_;
  std::vector<std::vector<std::byte>> heard_;
};

const std::vector<double> kTwist{0.25, 0, 0, 0, 0, -0.5};

TEST_F(RawTopicTest, sends_bytes) {
  RawPublisher publisher(session_, "/cmd_vel", "geometry_msgs/Twist");
  EXPECT_FALSE(publisher.has_subscribers());
  robot_.listen_twist("/cmd_vel");
  ASSERT_TRUE(eventually(20, [&] { return publisher.has_subscribers(); }));
  publisher.publish(bytes_of(kTwist));
  publisher.drain();
  ASSERT_TRUE(eventually(20, [&] { return !robot_.twists().empty(); }));
  EXPECT_EQ(robot_.twists().front().linear_x, 0.25);
  EXPECT_EQ(robot_.twists().front().angular_z, -0.5);
}

TEST_F(RawTopicTest, receives_bytes) {
  const RawSubscriber subscriber(session_, "/in", "Twist", keep());
  ASSERT_TRUE(eventually(20, [&] {
    robot_.publish_twist("/in", 0.25, -0.5);
    return !heard().empty();
  }));
  EXPECT_EQ(heard().front(), bytes_of(kTwist));
}

TEST_F(RawTopicTest, refuses_another_type) {
  const RawSubscriber arrays(session_, "/in", "std_msgs/Float64MultiArray", keep());
  robot_.publish_twist("/in", 1, 1);
  std::this_thread::sleep_for(std::chrono::seconds(1));
  robot_.publish_twist("/in", 1, 1);
  EXPECT_EQ(robot_.subscribers("/in"), 0);
  EXPECT_TRUE(heard().empty());
}

TEST_F(RawTopicTest, is_silent_after_its_end) {
  auto subscriber = std::make_unique<RawSubscriber>(session_, "/in", "Twist", keep());
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
  RawPublisher publisher(session_, "/scan", "sensor_msgs/LaserScan");
  const RawSubscriber subscriber(session_, "/scan", "sensor_msgs/LaserScan", keep());
  ASSERT_TRUE(eventually(20, [&] { return publisher.has_subscribers(); }));
  const std::vector<std::byte> scan(52, std::byte{0});
  for (std::size_t i = 0; i < 3; ++i) {
    publisher.publish(scan);
    ASSERT_TRUE(eventually(20, [&] { return heard().size() > i; }));
    auto numbered = scan;
    numbered[0] = static_cast<std::byte>(i);
    EXPECT_EQ(heard()[i], numbered);
  }
}

TEST_F(RawTopicTest, errors) {
  for (const std::string topic : {"", "1a", "a b", "~a"}) {
    const std::string text =
        "'" + topic +
        "' is no name of a ROS topic; write letters, digits, '_' and '/', beginning with a letter "
        "or '/', as in /cmd_vel";
    const auto error_of = [](auto action) -> std::string {
      try {
        action();
      } catch (const ConfigurationError& error) {
        return error.what();
      }
      return "no error";
    };
    EXPECT_EQ(error_of([&] { RawPublisher(session_, topic, "geometry_msgs/Twist"); }), text);
    EXPECT_EQ(error_of([&] { RawSubscriber(session_, topic, "geometry_msgs/Twist", keep()); }),
              text);
  }
  EXPECT_THROW(RawPublisher(session_, "/a", "geometry_msgs/Twits"), ConfigurationError);
  EXPECT_THROW(RawSubscriber(session_, "/a", "geometry_msgs/Twits", keep()), ConfigurationError);
}

}  // namespace
