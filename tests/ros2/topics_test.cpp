// Topics as bytes between two nodes over the loopback interface.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <condition_variable>
#include <cstring>
#include <mutex>
#include <thread>

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
  for (int i = 0; i < 20; ++i) {
    Heard heard;
    Session robot(settings("robot"));
    Session brain(settings("brain"));
    const auto publisher = robot.publisher("/first", "std_msgs/String");
    const auto subscriber = brain.subscriber(heard.subscription("/first", "std_msgs/String", 1));
    ASSERT_TRUE(eventually(kLong, [&] { return brain.publishers_know_us("/first"); }));
    publisher->publish(message_of(pattern(8)));
    ASSERT_TRUE(eventually(kLong, [&] { return heard.count() == 1; })) << "at attempt " << i;
  }
}

/// Holds up the session's thread in its first message.
class SlowListener {
 public:
  topics::Subscription subscription(std::uint32_t queue) {
    topics::Subscription wanted = heard_.subscription("/in", "std_msgs/String", queue);
    wanted.take = [this, take = wanted.take](std::span<const std::byte> message) {
      take(message);
      std::unique_lock lock(mutex_);
      changed_.wait(lock, [this] { return open_; });
    };
    return wanted;
  }
  void open() {
    const std::lock_guard lock(mutex_);
    open_ = true;
    changed_.notify_all();
  }
  const Heard& heard() const { return heard_; }

 private:
  Heard heard_;
  std::mutex mutex_;
  std::condition_variable changed_;
  bool open_ = false;
};

class QueueTest : public TopicsTest, public testing::WithParamInterface<std::uint32_t> {};

TEST_P(QueueTest, loses_the_oldest_beyond_its_length) {
  const std::uint32_t queue = GetParam();
  SlowListener slow;
  const auto publisher = robot_.publisher("/in", "std_msgs/String", 0);
  const auto subscriber = brain_.subscriber(slow.subscription(queue));
  wait_for_match(*publisher, *subscriber);
  publisher->publish(message_of(pattern(8, 0)));
  ASSERT_TRUE(eventually(kLong, [&] { return slow.heard().count() == 1; }));
  constexpr std::uint32_t kLast = 20;
  for (std::uint32_t i = 1; i <= kLast; ++i) {
    publisher->publish(message_of(pattern(8, i)));
  }
  publisher->drain();  // a reliable reader has them; another one, which acknowledges nothing, soon
  std::this_thread::sleep_for(std::chrono::milliseconds(200));
  slow.open();
  const std::size_t expected = 1 + (queue == 0 ? kLast : queue);
  ASSERT_TRUE(eventually(kLong, [&] { return slow.heard().count() == expected; }));
  const auto messages = slow.heard().messages();
  for (std::uint32_t i = 1; i < messages.size(); ++i) {
    EXPECT_EQ(fields_of(messages[messages.size() - i]), pattern(8, kLast + 1 - i));
  }
}

INSTANTIATE_TEST_SUITE_P(Lengths, QueueTest, testing::Values(0U, 1U, 3U));

TEST_F(TopicsTest, is_silent_after_its_end) {
  const auto publisher = robot_.publisher("/in", "std_msgs/String");
  auto first = brain_.subscriber(heard_.subscription("/in", "std_msgs/String", 1));
  wait_for_match(*publisher, *first);
  first.reset();
  const std::size_t before = heard_.count();
  Heard other;
  const auto second = brain_.subscriber(other.subscription("/in", "std_msgs/String", 1));
  ASSERT_TRUE(eventually(kLong, [&] {
    publisher->publish(message_of(pattern(8)));
    return other.count() > 0;
  }));
  EXPECT_EQ(heard_.count(), before);
}

TEST_F(TopicsTest, meets_itself) {
  const auto publisher = brain_.publisher("/in", "std_msgs/String");
  const auto subscriber = brain_.subscriber(heard_.subscription("/in", "std_msgs/String", 1));
  wait_for_match(*publisher, *subscriber);
  EXPECT_TRUE(eventually(kLong, [&] { return brain_.publishers_know_us("/in"); }));
  publisher->publish(message_of(pattern(5)));
  ASSERT_TRUE(eventually(kLong, [&] { return heard_.count() == 1; }));
  EXPECT_EQ(fields_of(heard_.messages().front()), pattern(5));
}

TEST_F(TopicsTest, publishes_from_any_thread_and_at_once) {
  const auto publisher = robot_.publisher("/in", "std_msgs/String", 0);
  const auto subscriber = brain_.subscriber(heard_.subscription("/in", "std_msgs/String", 0));
  wait_for_match(*publisher, *subscriber);
  std::thread([&] {
    publisher->publish(message_of(pattern(8)));
    publisher->drain();
  }).join();
  EXPECT_TRUE(eventually(kLong, [&] { return heard_.count() == 1; }));
}

TEST_F(TopicsTest, refuses_what_is_no_message_topic_or_type) {
  const auto publisher = robot_.publisher("/in", "std_msgs/String");
  const Bytes three(3);
  EXPECT_THROW(publisher->publish(three), std::logic_error);
  EXPECT_THROW(robot_.publisher("/in", "std_msgs/Strang"), ConfigurationError);
  EXPECT_THROW(robot_.publisher("/i n", "std_msgs/String"), ConfigurationError);
  EXPECT_THROW(brain_.subscriber(heard_.subscription("/i n", "std_msgs/String", 1)),
               ConfigurationError);
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
