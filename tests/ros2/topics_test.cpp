// Topics as bytes between two nodes over the loopback interface.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <cstring>

#include "spikeloop/core/error.hpp"
#include "spikeloop/ros2/session.hpp"
#include "tests/ros2/domain.hpp"
#include "tests/ros2/heard.hpp"

namespace {

using namespace spikeloop;
using ros2::Session;
using test::Bytes;
using test::eventually;
using test::fields_of;
using test::Heard;
using test::message_of;
using test::pattern;

constexpr double kLong = 20;  // seconds; nothing takes that long unless it is broken

class TopicsTest : public testing::Test {
 protected:
  topics::SessionSettings settings(const std::string& name) const {
    return {.node_name = name, .place = domain_.place()};
  }
  /// Both sides know each other: what is published from now on comes.
  void wait_for_match(const topics::RawPublisher& publisher,
                      const topics::RawSubscriber& subscriber) {
    ASSERT_TRUE(eventually(
        kLong, [&] { return publisher.has_subscribers() && subscriber.has_publishers(); }));
  }

  test::FreeDomain domain_;
  Heard heard_;
  Session robot_{settings("robot")};
  Session brain_{settings("brain")};
};

TEST_F(TopicsTest, brings_messages_of_every_size) {
  const auto publisher = robot_.publisher("/in", "std_msgs/String", 0);
  const auto subscriber = brain_.subscriber(heard_.subscription("/in", "std_msgs/String", 0));
  wait_for_match(*publisher, *subscriber);
  // No fields at all; up to a word; around Cyclone's fragments (1344 bytes) and UDP's limit; an
  // image.
  const std::vector<std::size_t> sizes{0,    1,    2,    3,     4,     5,     7,     1339,   1340,
                                       1341, 1344, 2688, 14719, 14720, 65507, 70000, 5000000};
  for (const std::size_t size : sizes) {
    publisher->publish(message_of(pattern(size)));
  }
  ASSERT_TRUE(eventually(kLong, [&] { return heard_.count() == sizes.size(); }));
  const auto messages = heard_.messages();
  for (std::size_t i = 0; i < sizes.size(); ++i) {
    EXPECT_TRUE(fields_of(messages[i]) == pattern(sizes[i])) << "of " << sizes[i] << " bytes";
  }
}

TEST_F(TopicsTest, loses_none_of_many_messages_when_every_one_is_wanted) {
  const auto publisher = robot_.publisher("/in", "std_msgs/String", 0);
  const auto subscriber = brain_.subscriber(heard_.subscription("/in", "std_msgs/String", 0));
  wait_for_match(*publisher, *subscriber);
  constexpr std::uint32_t kMany = 20000;
  for (std::uint32_t i = 0; i < kMany; ++i) {
    Bytes fields(100);
    std::memcpy(fields.data(), &i, sizeof i);
    publisher->publish(message_of(fields));
  }
  ASSERT_TRUE(eventually(kLong, [&] { return heard_.count() == kMany; }));
  const auto messages = heard_.messages();
  for (std::uint32_t i = 0; i < kMany; ++i) {
    std::uint32_t number = 0;
    std::memcpy(&number, messages[i].data() + 4, sizeof number);
    ASSERT_EQ(number, i);
  }
}

TEST_F(TopicsTest, knows_who_is_there) {
  const auto publisher = robot_.publisher("/in", "std_msgs/String");
  EXPECT_FALSE(publisher->has_subscribers());
  EXPECT_FALSE(brain_.publishers_know_us("/in"));
  {
    const auto subscriber = brain_.subscriber(heard_.subscription("/in", "std_msgs/String", 1));
    wait_for_match(*publisher, *subscriber);
    EXPECT_TRUE(eventually(kLong, [&] { return brain_.publishers_know_us("/in"); }));
  }
  EXPECT_TRUE(eventually(kLong, [&] { return !publisher->has_subscribers(); }));
}

TEST_F(TopicsTest, gets_what_is_published_once_the_publishers_know_us) {
  for (int i = 0; i < 50; ++i) {
    Heard heard;
    const std::string topic = "/in" + std::to_string(i);
    const auto publisher = robot_.publisher(topic, "std_msgs/String");
    const auto subscriber = brain_.subscriber(heard.subscription(topic, "std_msgs/String", 1));
    ASSERT_TRUE(eventually(kLong, [&] { return brain_.publishers_know_us(topic); }));
    publisher->publish(message_of(pattern(8)));
    ASSERT_TRUE(eventually(kLong, [&] { return heard.count() == 1; })) << "at attempt " << i;
  }
}

TEST_F(TopicsTest, says_which_other_type_a_topic_carries) {
  const auto before = robot_.publisher("/in", "geometry_msgs/Twist");
  const auto subscriber = brain_.subscriber(heard_.subscription("/in", "sensor_msgs/LaserScan", 1));
  ASSERT_TRUE(eventually(kLong, [&] { return heard_.refusals().size() == 1; }));
  const auto after = robot_.publisher("/in", "std_msgs/String");
  ASSERT_TRUE(eventually(kLong, [&] { return heard_.refusals().size() == 2; }));
  const auto refusals = heard_.refusals();
  EXPECT_EQ(refusals[0].type, "geometry_msgs/Twist");
  EXPECT_EQ(refusals[0].text,
            "topic '/in' carries geometry_msgs/Twist, not sensor_msgs/LaserScan; write message: "
            "geometry_msgs/Twist");
  EXPECT_EQ(refusals[1].type, "std_msgs/String");
  EXPECT_FALSE(subscriber->has_publishers());
  before->publish(message_of(pattern(48)));
  after->publish(message_of(pattern(48)));
  EXPECT_EQ(heard_.count(), 0U);
}

}  // namespace
