// Topics as bytes between two nodes over the loopback interface.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <condition_variable>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <mutex>
#include <thread>

#include "spikeloop/core/error.hpp"
#include "spikeloop/messages/catalog.hpp"
#include "spikeloop/ros2/session.hpp"
#include "tests/ros2/domain.hpp"
#include "tests/ros2/heard.hpp"
#include "tests/support/temporary_directory.hpp"

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

TEST_F(TopicsTest, has_lost_messages_sent_again_when_every_one_is_wanted) {
  topics::SessionSettings lossy = settings("far_robot");
  lossy.place["CYCLONEDDS_URI"] =
      "<CycloneDDS><Domain><Internal><Test><XmitLossiness>200</XmitLossiness></Test></Internal>"
      "</Domain></CycloneDDS>";  // per mille
  Session far_robot(lossy);
  const auto publisher = far_robot.publisher("/in", "std_msgs/String", 0);
  const auto subscriber = brain_.subscriber(heard_.subscription("/in", "std_msgs/String", 0));
  Heard newest;
  const auto best_effort = brain_.subscriber(newest.subscription("/in", "std_msgs/String", 10));
  wait_for_match(*publisher, *subscriber);
  constexpr std::uint32_t kMessages = 300;
  for (std::uint32_t i = 0; i < kMessages; ++i) {
    publisher->publish(message_of(pattern(16, i)));
  }
  ASSERT_TRUE(eventually(kLong, [&] { return heard_.count() >= kMessages; })) << heard_.count();
  for (std::uint32_t i = 0; i < kMessages; ++i) {
    ASSERT_EQ(fields_of(heard_.messages()[i]), pattern(16, i));
  }
  EXPECT_LT(newest.count(), kMessages) << "nothing was lost on the way";
}

/// A topic with a publisher that is latched, and one that is not.
class LatchedTest : public TopicsTest, public testing::WithParamInterface<std::uint32_t> {
 protected:
  std::unique_ptr<topics::RawPublisher> latched() {
    return robot_.publisher("/in", "std_msgs/String", 10, true);
  }
  std::unique_ptr<topics::RawPublisher> ordinary() {
    return robot_.publisher("/in", "std_msgs/String");
  }
  std::unique_ptr<topics::RawSubscriber> subscribe() {
    auto subscription = heard_.subscription("/in", "std_msgs/String", GetParam());
    subscription.latched = true;
    return brain_.subscriber(subscription);
  }
  void publish(topics::RawPublisher& publisher, std::uint32_t number) {
    publisher.publish(message_of(pattern(16, number)));
  }
  /// The seeds of what has come, 1 to 9.
  std::vector<std::uint32_t> numbers() const {
    std::vector<std::uint32_t> result;
    for (const Bytes& message : heard_.messages()) {
      for (std::uint32_t number = 1; number < 10; ++number) {
        if (fields_of(message) == pattern(16, number)) {
          result.push_back(number);
        }
      }
    }
    return result;
  }
  bool come(const std::vector<std::uint32_t>& wanted) {
    return eventually(kLong, [&] { return numbers() == wanted; });
  }
};

TEST_P(LatchedTest, brings_what_was_published_before) {
  const auto publisher = latched();
  publish(*publisher, 1);
  const auto subscriber = subscribe();
  ASSERT_TRUE(come({1}));
  publish(*publisher, 2);
  EXPECT_TRUE(come({1, 2}));
  EXPECT_TRUE(subscriber->latched());
  EXPECT_EQ(subscriber->lost(), 0U);
}

TEST_P(LatchedTest, brings_what_a_later_publisher_has_published_at_once) {
  const auto subscriber = subscribe();
  const auto publisher = latched();
  publish(*publisher, 1);
  EXPECT_TRUE(come({1}));
}

TEST_P(LatchedTest, asks_an_ordinary_publisher_for_nothing) {
  const auto other = ordinary();
  ASSERT_TRUE(eventually(kLong, [&] { return brain_.has_publishers("/in"); }));
  const auto publisher = latched();
  publish(*publisher, 1);
  const auto subscriber = subscribe();
  const auto come_of = [&](topics::RawPublisher& from, std::uint32_t number) {
    return eventually(kLong, [&] {
      publish(from, number);
      return !numbers().empty() && numbers().back() == number;
    });
  };
  EXPECT_TRUE(come_of(*publisher, 2));
  EXPECT_TRUE(come_of(*other, 3));
  EXPECT_EQ(numbers().front(), 2U);
  EXPECT_EQ(other->misfit(), "");
  EXPECT_FALSE(subscriber->latched());
}

TEST_P(LatchedTest, stays_connected_when_an_ordinary_publisher_comes_and_leaves) {
  const auto publisher = latched();
  publish(*publisher, 1);
  const auto subscriber = subscribe();
  ASSERT_TRUE(come({1}));
  auto other = ordinary();
  ASSERT_TRUE(eventually(kLong, [&] { return !subscriber->latched(); }));
  wait_for_match(*other, *subscriber);
  publish(*other, 2);
  ASSERT_TRUE(come({1, 2}));
  publish(*publisher, 3);
  ASSERT_TRUE(come({1, 2, 3}));
  other.reset();
  Session late_robot(settings("late_robot"));
  const auto late = late_robot.publisher("/in", "std_msgs/String", 1, true);
  publish(*late, 4);
  EXPECT_TRUE(come({1, 2, 3, 4})) << "repeated, or lost";
  publish(*publisher, 5);
  EXPECT_TRUE(come({1, 2, 3, 4, 5}));
}

INSTANTIATE_TEST_SUITE_P(Queues, LatchedTest, testing::Values(0U, 1U, 10U));

TEST_F(TopicsTest, brings_nothing_of_before_to_who_does_not_want_it) {
  const auto publisher = robot_.publisher("/in", "std_msgs/String", 1, true);
  publisher->publish(message_of(pattern(16, 1)));
  const auto subscriber = brain_.subscriber(heard_.subscription("/in", "std_msgs/String", 1));
  wait_for_match(*publisher, *subscriber);
  publisher->publish(message_of(pattern(16, 2)));
  ASSERT_TRUE(eventually(kLong, [&] { return heard_.count() > 0; }));
  EXPECT_EQ(fields_of(heard_.messages().front()), pattern(16, 2));
}

TEST_F(TopicsTest, knows_who_is_there) {
  const auto publisher = robot_.publisher("/in", "std_msgs/String");
  EXPECT_FALSE(publisher->has_subscribers());
  EXPECT_FALSE(brain_.publishers_are_connected("/in"));
  {
    const auto subscriber = brain_.subscriber(heard_.subscription("/in", "std_msgs/String", 1));
    wait_for_match(*publisher, *subscriber);
    EXPECT_TRUE(eventually(kLong, [&] { return brain_.publishers_are_connected("/in"); }));
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
    ASSERT_TRUE(eventually(kLong, [&] { return brain.publishers_are_connected("/first"); }));
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
  // The kernel has them all; Cyclone's thread has to take them from it, and tells nobody when it
  // has.
  std::this_thread::sleep_for(std::chrono::seconds(1));
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
  EXPECT_TRUE(eventually(kLong, [&] { return brain_.publishers_are_connected("/in"); }));
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
  EXPECT_EQ(refusals[0].text, "topic '/in' carries geometry_msgs/Twist, not sensor_msgs/LaserScan");
  EXPECT_EQ(refusals[1].type, "std_msgs/String");
  EXPECT_FALSE(subscriber->has_publishers());
  before->publish(message_of(pattern(48)));
  after->publish(message_of(pattern(48)));
  EXPECT_EQ(heard_.count(), 0U);
}

/// One distribution per test: the sessions of the fixture follow the first node that they discover.
class NamesOfSubscribersTest : public TopicsTest {
 protected:
  void expect_names(const char* distribution) {
    topics::SessionSettings named = settings("base");
    named.arguments = {{"__ns", "/left"}};
    named.place["ROS_DISTRO"] = distribution;
    Session base(named);
    const auto one = base.subscriber(heard_.subscription("/go", "geometry_msgs/TwistStamped", 1));
    const auto other = base.subscriber(heard_.subscription("/scan", "sensor_msgs/LaserScan", 1));
    Session brain(settings("brain"));
    ASSERT_TRUE(eventually(kLong, [&] {
      const auto found = brain.subscribers("/go");
      return found.size() == 1 && found[0].node == "/left/base";
    }));
    EXPECT_EQ(brain.subscribers("/go")[0].type, "geometry_msgs/TwistStamped");
  }
};

TEST_F(NamesOfSubscribersTest, come_in_lists_with_identities_of_24_bytes) {
  expect_names("humble");
}

TEST_F(NamesOfSubscribersTest, come_in_lists_with_identities_of_16_bytes) {
  expect_names("jazzy");
}

TEST_F(TopicsTest, names_the_publisher_of_another_type) {
  topics::SessionSettings named = settings("base");
  named.place["ROS_DISTRO"] = "jazzy";
  Session base(named);
  const auto publisher = base.publisher("/in", "geometry_msgs/Twist");
  const auto subscriber = brain_.subscriber(heard_.subscription("/in", "sensor_msgs/LaserScan", 1));
  ASSERT_TRUE(eventually(kLong, [&] { return heard_.refusals().size() == 1; }));
  EXPECT_TRUE(eventually(kLong, [&] { return heard_.refusals()[0].node() == "/base"; }));
}

/// A user's own definition, in a folder as ROS wants it.
std::string message_file(const std::filesystem::path& folder, const std::string& text) {
  std::filesystem::create_directories(folder / "test_msgs/msg");
  const auto path = folder / "test_msgs/msg/Reading.msg";
  std::ofstream(path) << text;
  return path.string();
}

TEST_F(TopicsTest, says_which_other_version_a_topic_carries) {
  const test::TemporaryDirectory one;
  const test::TemporaryDirectory two;
  const std::string theirs = message_file(one.path(), "float64 value\n");
  const std::string ours = message_file(two.path(), "float32 value\n");
  const auto publisher = robot_.publisher("/in", theirs);
  const auto subscriber = brain_.subscriber(heard_.subscription("/in", ours, 1));
  ASSERT_TRUE(eventually(kLong, [&] { return heard_.refusals().size() == 1; }));
  const auto hash = [](const std::string& file) {
    const auto& catalog = messages::Catalog::for_type(messages::Dialect::ros2, file);
    return catalog.type_hash(catalog.full_name(file));
  };
  const auto refusal = heard_.refusals().front();
  EXPECT_EQ(refusal.type, "");
  EXPECT_EQ(refusal.text,
            "topic '/in' carries another version of test_msgs/Reading: its type hash is " +
                hash(theirs) + ", ours " + hash(ours) +
                "; write the path of the publisher's .msg file as the type");
}

}  // namespace
