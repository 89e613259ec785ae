// Messages of ROS 2 that are larger than the receive buffer.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "spikeloop/core/log.hpp"
#include "spikeloop/ros2/session.hpp"
#include "spikeloop/topics/sensor.hpp"
#include "step_data.hpp"
#include "tests/ros2/domain.hpp"
#include "tests/ros2/heard.hpp"

namespace {

using namespace spikeloop;
using test::Bytes;
using test::Heard;

constexpr double kPatience = 60;  // seconds
constexpr std::chrono::milliseconds kPeriod{20};
constexpr std::size_t kMessages = 20;

class LargeMessagesTest : public testing::Test {
 protected:
  ~LargeMessagesTest() override { log::set_sink({}); }

  static topics::Place with_small_buffer(topics::Place place) {
    place["CYCLONEDDS_URI"] =
        "<CycloneDDS><Domain><Internal><SocketReceiveBufferSize min=\"0\" max=\"10 kB\"/>"
        "</Internal></Domain></CycloneDDS>";
    return place;
  }
  /// The buffer holds 1,250 of these.
  static Bytes message_of_numbers(std::uint32_t count) {
    Bytes message = test::message_of(Bytes(16 + 8 * std::size_t{count}));  // no dimensions
    std::memcpy(message.data() + 12, &count, sizeof count);
    return message;
  }
  topics::Subscription subscription(bool reliable) {
    topics::Subscription wanted = heard_.subscription("/in", kType, 10);
    wanted.reliable = reliable;
    return wanted;
  }
  void wait_for_match(const topics::RawPublisher& publisher) {
    ASSERT_TRUE(test::eventually(kPatience, [&] { return publisher.has_subscribers(); }));
  }

  static constexpr const char* kType = "std_msgs/Float64MultiArray";
  test::FreeDomain domain_;
  Heard heard_;
  ros2::Session camera_{{.node_name = "camera", .place = domain_.place()}};
  ros2::Session brain_{{.node_name = "brain", .place = with_small_buffer(domain_.place())}};
};

TEST_F(LargeMessagesTest, come_whole_where_both_sides_are_reliable) {
  const auto publisher = camera_.publisher("/in", kType);
  const auto subscriber = brain_.subscriber(subscription(true));
  wait_for_match(*publisher);
  // The first one is from before the reader, which comes with its first publisher.
  ASSERT_TRUE(test::eventually(kPatience, [&] {
    publisher->publish(message_of_numbers(125'000));
    return test::eventually(0.5, [&] { return heard_.count() > 0; });
  }));
  for (std::size_t i = 0; i < kMessages; ++i) {
    const std::size_t before = heard_.count();
    publisher->publish(message_of_numbers(125'000));
    ASSERT_TRUE(test::eventually(kPatience, [&] { return heard_.count() > before; })) << i;
  }
  EXPECT_EQ(heard_.messages().back(), message_of_numbers(125'000));
}

TEST_F(LargeMessagesTest, are_counted_when_they_do_not_arrive) {
  const auto publisher = camera_.publisher("/in", kType);
  const auto subscriber = brain_.subscriber(subscription(false));
  wait_for_match(*publisher);
  std::size_t sent = 0;
  const auto send = [&](std::uint32_t numbers) {
    publisher->publish(message_of_numbers(numbers));
    ++sent;
    std::this_thread::sleep_for(kPeriod);
  };
  const auto known = [&] { return heard_.count() + *subscriber->lost(); };
  // What was sent before the first one that is heard need not be counted.
  ASSERT_TRUE(test::eventually(kPatience, [&] {
    send(1);
    return heard_.count() > 0;
  }));
  const std::size_t uncounted = sent - 1;
  for (std::size_t i = 0; i < kMessages; ++i) {
    send(125'000);
    subscriber->lost();
  }
  // A message that is lost whole is known to be lost when a later one comes.
  EXPECT_TRUE(test::eventually(kPatience,
                               [&] {
                                 send(1);
                                 return known() + uncounted >= sent;
                               }))
      << heard_.count() << " heard, " << *subscriber->lost() << " lost, " << sent << " sent";
  EXPECT_LE(known(), sent);
  EXPECT_GT(*subscriber->lost(), 0U) << "the buffer is large enough";
}

/// A part of the messages arrives: large ones between small ones.
TEST_F(LargeMessagesTest, are_reported_when_a_part_is_lost) {
  std::mutex mutex;
  std::vector<std::string> said;
  log::set_sink([&](log::Level, std::string_view message) {
    const std::lock_guard lock(mutex);
    said.emplace_back(message);
  });
  const auto publisher = camera_.publisher("/in", kType);
  test::OutputData data({1, 1});
  topics::Sensor sensor(brain_, {.topic = "/in", .message_type = kType, .width = 1});
  wait_for_match(*publisher);
  const auto drive = [&](double seconds, std::uint32_t numbers) {
    return test::eventually(seconds, [&] {
      publisher->publish(message_of_numbers(1));
      publisher->publish(message_of_numbers(numbers));
      std::this_thread::sleep_for(kPeriod);
      sensor.receive(data.step());
      const std::lock_guard lock(mutex);
      return std::ranges::any_of(said, [](const std::string& text) {
        return text.find(
                   "messages were lost, because the receive buffer is too small for them; give "
                   "the system a larger one: sysctl -w net.core.rmem_max=8388608") !=
               std::string::npos;
      });
    });
  };
  EXPECT_FALSE(drive(3, 1)) << "nothing is lost";
  EXPECT_TRUE(drive(kPatience, 125'000));
  const std::lock_guard lock(mutex);
  EXPECT_EQ(std::ranges::count_if(said,
                                  [](const std::string& text) {
                                    return text.find("were lost") != std::string::npos;
                                  }),
            1);
}

TEST_F(LargeMessagesTest, leave_a_word_on_the_buffer) {
  std::mutex mutex;
  std::string said;
  log::set_sink([&](log::Level, std::string_view message) {
    const std::lock_guard lock(mutex);
    said += message;
  });
  const auto publisher = camera_.publisher("/in", kType);
  const auto is_told = [&] {
    const std::lock_guard lock(mutex);
    return said.find(
               "topic '/in' has a publisher, but no message of it arrives whole; give the "
               "system a larger receive buffer: sysctl -w net.core.rmem_max=8388608") !=
           std::string::npos;
  };
  test::OutputData data({600'000, 1});
  // Rarely, a message comes whole all the same: then another sensor tries.
  EXPECT_TRUE(test::eventually(kPatience, [&] {
    topics::Sensor sensor(brain_, {.topic = "/in", .message_type = kType, .width = 600'000});
    wait_for_match(*publisher);
    return test::eventually(kPatience,
                            [&] {
                              publisher->publish(message_of_numbers(600'000));
                              sensor.receive(data.step());
                              std::this_thread::sleep_for(5 * kPeriod);
                              return is_told() || sensor.received() > 0;
                            }) &&
           is_told();
  })) << said;
}

}  // namespace
