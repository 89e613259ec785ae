// Topics as sources, over every kind of session.
#include "spikeloop/topics/sensor.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <mutex>

#include "meeting.hpp"
#include "spikeloop/core/error.hpp"
#include "spikeloop/core/log.hpp"
#include "spikeloop/core/pacer.hpp"
#include "step_data.hpp"
#include "tests/ros2/domain.hpp"
#include "tests/support/fault.hpp"

namespace {

using spikeloop::test::Fault;
using namespace spikeloop;
using namespace spikeloop::topics;
using test::eventually;
using testing::ElementsAre;

constexpr float kInf = std::numeric_limits<float>::infinity();
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

class SensorTest : public testing::TestWithParam<test::Kind> {
 protected:
  ~SensorTest() override { log::set_sink({}); }

  std::unique_ptr<Sensor> sensor(const std::string& type, std::uint32_t width) {
    return std::make_unique<Sensor>(
        session_, SensorSettings{.topic = "/in", .message_type = type, .width = width});
  }
  static std::uint64_t count(const Sensor& sensor, std::string_view name) {
    for (const Counter& counter : sensor.counters()) {
      if (counter.name == name) {
        return counter.value;
      }
    }
    ADD_FAILURE() << name;
    return 0;
  }
  /// Publishes until the sensor has taken the first message.
  template <typename Publish>
  bool until_taken(const Sensor& sensor, Publish publish) {
    return eventually(20, [&] {
      publish();
      return count(sensor, "messages") + count(sensor, "wrong_type") > 0;
    });
  }
  static std::string error_of(Sensor& sensor, test::OutputData& data) {
    try {
      sensor.receive(data.step());
    } catch (const Error& error) {
      return error.what();
    }
    return "no error";
  }

  std::unique_ptr<test::Meeting> meeting_ = test::meet(GetParam());
  topics::Session& session_ = meeting_->session();
  test::Meeting& robot_ = *meeting_;
};

TEST_P(SensorTest, newest_scan_and_its_time) {
  const auto scans = sensor("sensor_msgs/LaserScan", 5);
  test::OutputData data({5, 1});
  scans->receive(data.step());
  EXPECT_EQ(data.revision(0), 0u);
  EXPECT_EQ(data.revision(1), 0u);
  const TimeNs before = wall_now();
  ASSERT_TRUE(until_taken(*scans, [&] {
    robot_.publish_scan("/in", {-kInf, kInf, 2.5f, 0.1f, kNan}, 0.5f, 4.5f);
  }));
  scans->receive(data.step());
  EXPECT_THAT(data.values(0), ElementsAre(-1, 1, 0, -1, testing::IsNan()));
  EXPECT_GE(data.values(1)[0], to_seconds(before));
  EXPECT_LE(data.values(1)[0], to_seconds(wall_now()));
  const std::uint64_t revision = data.revision(0);
  const std::uint64_t taken = count(*scans, "messages");
  robot_.publish_scan("/in", {1.5f, 1.5f, 1.5f, 1.5f, 1.5f}, 0.5f, 4.5f);
  ASSERT_TRUE(eventually(20, [&] { return count(*scans, "messages") > taken; }));
  EXPECT_TRUE(eventually(20, [&] {
    scans->receive(data.step());
    return data.values(0)[4] == -0.5;
  }));
  EXPECT_GT(data.revision(0), revision);
  const std::uint64_t last = data.revision(0);
  scans->receive(data.step());
  EXPECT_EQ(data.revision(0), last) << "no new message, no new revision";
  EXPECT_GE(count(*scans, "invalid_readings"), 1u);
}

TEST_P(SensorTest, initial_value_until_the_first_message) {
  Sensor source(session_,
                {.topic = "/in", .message_type = "Odometry", .width = 2, .initial = 0.25});
  test::OutputData data({2, 1});
  source.receive(data.step());
  EXPECT_THAT(data.values(0), ElementsAre(0.25, 0.25));
  EXPECT_EQ(data.revision(0), 1u);
  EXPECT_EQ(data.revision(1), 0u);
  ASSERT_TRUE(until_taken(source, [&] { robot_.publish_odometry("/in", 3, -4, 5); }));
  EXPECT_TRUE(eventually(20, [&] {
    source.receive(data.step());
    return data.revision(0) > 1;
  }));
  EXPECT_THAT(data.values(0), ElementsAre(3, -4));
}

TEST_P(SensorTest, another_type_on_the_topic) {
  const auto scans = sensor("sensor_msgs/LaserScan", 5);
  test::OutputData data({5, 1});
  ASSERT_TRUE(until_taken(*scans, [&] { robot_.publish_twist("/in", 1, 2); }));
  std::string error;  // a moment later, if the node has no name
  EXPECT_TRUE(eventually(20, [&] {
    error = error_of(*scans, data);
    return error != "no error";
  }));
  EXPECT_THAT(
      error, Fault("topic '/in' carries geometry_msgs/Twist, not sensor_msgs/LaserScan; ... write  "
                   "message: geometry_msgs/Twist  (in a .music file  "
                   "message_type=geometry_msgs/Twist), or another topic [SL0508]"));
}

TEST_P(SensorTest, warnings_come_once) {
  std::mutex mutex;
  std::vector<std::string> warnings;
  log::set_sink([&](log::Level, std::string_view text) {
    const std::lock_guard lock(mutex);
    warnings.emplace_back(text);
  });
  const auto arrays = sensor("std_msgs/Float64MultiArray", 2);
  ASSERT_TRUE(until_taken(*arrays, [&] { robot_.publish_array("/in", {1, 2, 3}); }));
  ASSERT_TRUE(eventually(20, [&] {
    robot_.publish_array("/in", {1, 2, 3});
    return count(*arrays, "cropped") >= 20;
  }));
  const std::lock_guard lock(mutex);
  EXPECT_THAT(warnings,
              ElementsAre(Fault("... topic '/in': a std_msgs/Float64MultiArray ... 3 ... 2 ...")));
}

TEST_P(SensorTest, strict_ends_the_run) {
  Sensor source(
      session_,
      {.topic = "/in", .message_type = "std_msgs/Float64MultiArray", .width = 2, .strict = true});
  test::OutputData data({2, 1});
  ASSERT_TRUE(eventually(20, [&] {
    robot_.publish_array("/in", {1, 2, 3});
    return error_of(source, data) != "no error";
  }));
  EXPECT_THAT(error_of(source, data), Fault("topic '/in': a std_msgs/Float64MultiArray brought 3 "
                                            "... 2 channels ... [3] ... [SL0505]"));
  EXPECT_GT(count(source, "messages"), 0U);  // nobody is to say that none has come
}

TEST_P(SensorTest, impossible_topic) {
  try {
    Sensor source(session_, {.topic = "my topic", .message_type = "Twist", .width = 2});
    FAIL();
  } catch (const ConfigurationError& error) {
    EXPECT_THAT(error.what(), Fault("'my topic' ... [SL0501] ..."));
  }
}

INSTANTIATE_TEST_SUITE_P(AllSessions, SensorTest, test::kinds());

}  // namespace
