#include "spikeloop/messages/sensor_conversion.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "spikeloop/core/error.hpp"
#include "spikeloop/messages/message_writer.hpp"
#include "tests/support/error_of.hpp"

namespace sensor_conversion_test {
namespace {

using spikeloop::test::Fault;
using namespace spikeloop::messages;
using spikeloop::test::error_of;
using testing::ElementsAre;
using testing::EndsWith;
using testing::IsNan;

constexpr double kInf = std::numeric_limits<double>::infinity();
const double kNan = std::nan("");

std::vector<std::byte> message(std::string_view type, std::vector<std::string> paths,
                               const std::vector<std::vector<double>>& numbers) {
  std::vector<FieldValue> values;
  for (const auto& each : numbers) {
    values.push_back({each, {}});
  }
  std::vector<std::byte> bytes;
  MessageWriter(Catalog::builtin(Dialect::ros1), type, std::move(paths)).write(values, bytes);
  return bytes;
}

std::vector<std::byte> scan(const std::vector<double>& ranges, double least = 0.5,
                            double most = 4.5) {
  return message("LaserScan", {"range_min", "range_max", "ranges"}, {{least}, {most}, ranges});
}

SensorConversion conversion(std::string_view type, std::uint32_t width, bool strict = false,
                            const std::vector<std::string>& fields = {}) {
  return SensorConversion(Catalog::builtin(Dialect::ros1), type, plain_fields(fields), width,
                          strict);
}

TEST(SensorConversion, scan_is_scaled_to_one) {
  auto c = conversion("sensor_msgs/LaserScan", 4);
  EXPECT_TRUE(c.convert(scan({0.5, 1.5, 2.5, 4.5})));
  EXPECT_THAT(c.channels(), ElementsAre(-1.0, -0.5, 0.0, 1.0));
}

// REP 117: -inf too close, +inf nothing in range, NaN no reading.
TEST(SensorConversion, readings_outside_the_range_mean_what_rep_117_says) {
  auto c = conversion("LaserScan", 6);
  EXPECT_TRUE(c.convert(scan({-kInf, 0.25, -2, kInf, 5, 2.5})));
  EXPECT_THAT(c.channels(), ElementsAre(-1.0, -1.0, -1.0, 1.0, 1.0, 0.0));
  EXPECT_EQ(c.counts().invalid_readings, 0u);
}

TEST(SensorConversion, no_reading_keeps_the_beam_s_last_value) {
  auto c = conversion("LaserScan", 3);
  EXPECT_TRUE(c.convert(scan({kNan, 2.5, 0})));
  EXPECT_THAT(c.channels(), ElementsAre(IsNan(), 0.0, IsNan()));
  EXPECT_TRUE(c.convert(scan({1.5, kNan, 1.5})));
  EXPECT_TRUE(c.convert(scan({0, kNan, 3.5})));
  EXPECT_THAT(c.channels(), ElementsAre(-0.5, 0.0, 0.5));
  EXPECT_EQ(c.counts().invalid_readings, 2u + 1 + 2);
  EXPECT_EQ(c.counts().messages, 3u);
}

TEST(SensorConversion, longer_scans_are_cropped_with_one_warning) {
  auto c = conversion("LaserScan", 2);
  EXPECT_TRUE(c.convert(scan({1.5, 2.5, 3.5, 4.5})));
  EXPECT_THAT(c.channels(), ElementsAre(-0.5, 0.0));
  EXPECT_EQ(c.take_warning(),
            "a sensor_msgs/LaserScan brought 4 values, but the port has 2 channels: surplus values "
            "are left out, and channels without a value keep their last one; set the sensor's key "
            "'beams' to 2 to resample scans by angle, or write [4] in its connection to have all");
  EXPECT_TRUE(c.convert(scan({1.5, 2.5, 3.5, 4.5})));
  EXPECT_EQ(c.take_warning(), "");
  EXPECT_EQ(c.counts().cropped, 2u);
}

TEST(SensorConversion, shorter_scans_leave_the_rest_as_it_was) {
  auto c = conversion("LaserScan", 3);
  EXPECT_TRUE(c.convert(scan({1.5, 2.5, 3.5})));
  EXPECT_TRUE(c.convert(scan({2.5})));
  EXPECT_THAT(c.channels(), ElementsAre(0.0, 0.0, 0.5));
  EXPECT_THAT(c.take_warning(),
              EndsWith("set the sensor's key 'beams' to 3 to resample scans by angle"))
      << "[1] would be too few: a message had more";
  EXPECT_EQ(c.counts().short_messages, 1u);
  EXPECT_TRUE(c.convert(scan({1.5, 1.5, 1.5, 1.5})));
  EXPECT_THAT(c.channels(), ElementsAre(-0.5, -0.5, -0.5));
  EXPECT_EQ(c.take_warning(), "") << "one warning is enough";
  EXPECT_EQ(c.counts().cropped, 1u);
}

TEST(SensorConversion, the_first_shorter_scan_names_its_width) {
  auto c = conversion("LaserScan", 3);
  EXPECT_TRUE(c.convert(scan({2.5})));
  EXPECT_THAT(c.take_warning(),
              Fault("a sensor_msgs/LaserScan brought 1 value, ... 3 channels ... 'beams' ... [1] "
                    "... if no message has more"));
}

TEST(SensorConversion, fields_of_any_length_keep_their_channels) {
  const auto echoes = [](const std::vector<double>& ranges, const std::vector<double>& strengths) {
    return message("LaserScan", {"ranges", "intensities", "range_max"}, {ranges, strengths, {9}});
  };
  const std::vector<std::string> fields{"ranges", "intensities", "range_max"};
  auto c = conversion("LaserScan", 7, false, fields);
  EXPECT_TRUE(c.convert(echoes({1, 2}, {10, 20, 30})));  // nothing fits yet: three and three
  EXPECT_THAT(c.channels(), ElementsAre(1, 2, IsNan(), 10, 20, 30, 9));
  EXPECT_THAT(c.take_warning(),
              Fault("a sensor_msgs/LaserScan brought 2 values in 'ranges', but 3 of the channels "
                    "... [6] in its connection ..."));
  EXPECT_TRUE(c.convert(echoes({1, 2, 3, 4}, {40, 50, 60, 70})));
  EXPECT_THAT(c.channels(), ElementsAre(1, 2, 3, 40, 50, 60, 9));
  EXPECT_TRUE(c.convert(echoes({5, 6}, {7, 8, 9, 10})));  // fits: two and four from now on
  EXPECT_THAT(c.channels(), ElementsAre(5, 6, 7, 8, 9, 10, 9));
  EXPECT_TRUE(c.convert(echoes({1, 1, 1}, {})));
  EXPECT_THAT(c.channels(), ElementsAre(1, 1, 7, 8, 9, 10, 9));
  EXPECT_EQ(c.take_warning(), "");
  EXPECT_EQ(c.counts().short_messages, 1u);
  EXPECT_EQ(c.counts().cropped, 2u);
  EXPECT_THAT(error_of([&] {
                conversion("LaserScan", 7, true, fields).convert(echoes({1, 2}, {10, 20, 30}));
              }),
              Fault("... 2 values in 'ranges' ... [6] ... [SL0505]"));
}

TEST(SensorConversion, strict_names_both_widths) {
  const auto text = [](std::size_t beams) {
    return error_of(
        [&] { conversion("LaserScan", 2, true).convert(scan(std::vector<double>(beams, 1.0))); });
  };
  EXPECT_THAT(
      text(3),
      Fault("a sensor_msgs/LaserScan brought 3 values ... 2 channels ... [3] ... [SL0505]"));
  EXPECT_THAT(
      text(1),
      Fault("a sensor_msgs/LaserScan brought 1 value, ... 2 channels ... [1] ... [SL0505]"));
  EXPECT_EQ(text(2), "no error");
  EXPECT_THAT(error_of([] { conversion("Twist", 3, true); }),
              Fault("a geometry_msgs/Twist gives 2 values ... 3 channels ... [2] ... [SL0505]"));
  EXPECT_EQ(error_of([] { conversion("Odometry", 2, true); }), "no error");
}

TEST(SensorConversion, malformed_messages_change_nothing) {
  auto c = conversion("LaserScan", 1);
  EXPECT_TRUE(c.convert(scan({1.5})));
  auto cut = scan({2.5});
  cut.resize(20);
  EXPECT_FALSE(c.convert(cut));
  EXPECT_THAT(c.take_warning(),
              Fault("a sensor_msgs/LaserScan ... message of 20 ... (at byte 20) ... [SL0509]"));
  EXPECT_FALSE(c.convert(scan({2.5}, 4, 4)));
  EXPECT_FALSE(c.convert(scan({2.5}, 4, 3)));
  EXPECT_EQ(c.take_warning(), "");
  EXPECT_THAT(c.channels(), ElementsAre(-0.5));
  EXPECT_EQ(c.counts().malformed, 3u);
  auto other = conversion("LaserScan", 1);
  EXPECT_FALSE(other.convert(scan({2.5}, 4, 4)));
  EXPECT_THAT(
      other.take_warning(),
      Fault("a sensor_msgs/LaserScan could not be read and is left out: range_min 4 is not below "
            "range_max 4; set the sensor's key 'range' to the limits in metres, as in [0, 10] "
            "[SL0509]"));
}

TEST(SensorConversion, twist_is_limited) {
  auto c = conversion("Twist", 2);
  c.convert(message("Twist", {"linear.x", "linear.y", "angular.z"}, {{0.25}, {9}, {-3}}));
  EXPECT_THAT(c.channels(), ElementsAre(0.25, -1.0));
  auto narrow = conversion("Twist", 1);
  narrow.convert(message("Twist", {"linear.x"}, {{0.25}}));
  EXPECT_THAT(narrow.channels(), ElementsAre(0.25));
  EXPECT_EQ(narrow.counts().cropped, 1u);
}

TEST(SensorConversion, arrays_and_positions_are_raw) {
  auto c = conversion("Float64MultiArray", 3);
  c.convert(message("Float64MultiArray", {"data"}, {{7, -3, kInf}}));
  EXPECT_THAT(c.channels(), ElementsAre(7, -3, kInf));
  const auto odometry = message("Odometry",
                                {"pose.pose.position.x", "pose.pose.position.y",
                                 "pose.pose.position.z", "twist.twist.angular.z"},
                                {{10}, {20}, {30}, {0.5}});
  for (const std::uint32_t width : {1u, 2u, 3u}) {
    auto position = conversion("Odometry", width);
    position.convert(odometry);
    for (std::uint32_t i = 0; i < width; ++i) {
      EXPECT_EQ(position.channels()[i], 10.0 * (i + 1));
    }
    EXPECT_EQ(position.counts().cropped, 0u);
  }
  auto chosen = conversion("Odometry", 2, true, {"twist.twist.angular.z", "pose.pose.position.x"});
  chosen.convert(odometry);
  EXPECT_THAT(chosen.channels(), ElementsAre(0.5, 10));
}

TEST(SensorConversion, a_name_that_no_message_has_is_reported_with_the_names_there) {
  for (const char* type : {"sensor_msgs/JointState", "tf2_msgs/TFMessage"}) {
    const bool joints = std::string(type) == "sensor_msgs/JointState";
    auto c = conversion(
        type, 1, false,
        {joints ? "position[name=lft]" : "transforms[child_frame_id=lft].transform.translation.x"});
    const std::vector<std::string> fields =
        joints
            ? std::vector<std::string>{"position[name=left]", "position[name=right]"}
            : std::vector<std::string>{"transforms[child_frame_id=left].transform.translation.x",
                                       "transforms[child_frame_id=right].transform.translation.x"};
    EXPECT_FALSE(c.convert(message(type, fields, {{1}, {2}})));
    EXPECT_THAT(c.take_warning(), Fault("a " + std::string(type) +
                                        " brought no reading in '...', but has the names [left, "
                                        "right], so the channels have no value"));
  }
}

TEST(SensorConversion, the_remedy_counts_the_values_of_all_fields) {
  const auto brought = [](std::uint32_t width, const std::vector<double>& velocities) {
    auto c = conversion("sensor_msgs/JointState", width, false, {"position", "velocity"});
    c.convert(message("sensor_msgs/JointState", {"position", "velocity"}, {{1, 2}, velocities}));
    return c.take_warning();
  };
  EXPECT_THAT(brought(6, {3, 4}), EndsWith("write [4] in its connection if no message has more"));
  EXPECT_THAT(brought(5, {3, 4}), EndsWith("write [4] in its connection if no message has more"));
  EXPECT_EQ(brought(4, {3, 4}), "");
  EXPECT_THAT(brought(3, {3, 4}), EndsWith("write [4] in its connection to have all"));
  EXPECT_THAT(brought(6, {3}), EndsWith("write [3] in its connection if no message has more"));
}

TEST(SensorConversion, types_without_a_rule_need_fields) {
  EXPECT_THAT(error_of([] { conversion("std_msgs/Float64", 1); }),
              Fault("message type std_msgs/Float64 has no default fields; ... fields: [PATH, PATH] "
                    "... [SL0504]"));
  auto c = conversion("std_msgs/Float64", 1, true, {"data"});
  c.convert(message("std_msgs/Float64", {"data"}, {{42}}));
  EXPECT_THAT(c.channels(), ElementsAre(42));
}

}  // namespace
}  // namespace sensor_conversion_test
