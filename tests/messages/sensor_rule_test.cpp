// What a rule makes of messages, in both dialects: options of fields, pictures, point clouds.
#include "spikeloop/messages/sensor_rule.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>

#include "spikeloop/messages/sensor_conversion.hpp"
#include "tests/messages/sensor_rules.hpp"
#include "tests/support/fault.hpp"

namespace sensor_rule_test {
namespace {

using spikeloop::test::Fault;
using namespace spikeloop::messages;
using spikeloop::images::Channel;
using spikeloop::images::Size;
using testing::DoubleEq;
using testing::ElementsAre;
using testing::IsNan;

constexpr double kInf = std::numeric_limits<double>::infinity();
const double kNan = std::nan("");

INSTANTIATE_TEST_SUITE_P(Dialects, SensorRules, testing::Values(Dialect::ros1, Dialect::ros2),
                         [](const auto& dialect) {
                           return dialect.param == Dialect::ros1 ? "ros1" : "ros2";
                         });

TEST_P(SensorRules, plain_fields_are_taken_as_they_are) {
  auto c = conversion("LaserScan", plain_fields({"ranges[1:3]", "ranges[0]"}), 3, true);
  EXPECT_TRUE(c.convert(scan({5, -kInf, kNan, 8})));
  EXPECT_THAT(c.channels(), ElementsAre(-kInf, IsNan(), 5));
  EXPECT_EQ(c.counts().invalid_readings, 0u);
}

TEST_P(SensorRules, scale_offset_then_limits) {
  const SensorField scaled{
      .path = "ranges", .scale = 2, .offset = -1, .minimum = -0.5, .maximum = 4};
  auto c = conversion("LaserScan", {.fields = {scaled}}, 5);
  EXPECT_TRUE(c.convert(scan({0, 0.5, 2, 9, kInf})));
  EXPECT_THAT(c.channels(), ElementsAre(-0.5, 0, 3, 4, 4));
}

TEST_P(SensorRules, each_field_has_its_own_options) {
  auto c = conversion("LaserScan",
                      {.fields = {{.path = "ranges[0]", .scale = 10},
                                  {.path = "ranges[0]", .offset = 3},
                                  {.path = "ranges[1:]", .maximum = 1}}},
                      4);
  EXPECT_TRUE(c.convert(scan({1, 2, 0.5})));
  EXPECT_THAT(c.channels(), ElementsAre(10, 4, 1, 0.5));
}

TEST_P(SensorRules, not_a_number) {
  const auto rule = [](NotANumber policy, double instead = 0) {
    return SensorRule{.fields = {{.path = "ranges",
                                  .scale = 2,
                                  .maximum = 50,
                                  .not_a_number = policy,
                                  .instead = instead}}};
  };
  auto hold = conversion("LaserScan", rule(NotANumber::hold), 2);
  EXPECT_TRUE(hold.convert(scan({1, kNan})));
  EXPECT_THAT(hold.channels(), ElementsAre(2, IsNan()));
  EXPECT_TRUE(hold.convert(scan({kNan, 3})));
  EXPECT_THAT(hold.channels(), ElementsAre(2, 6));
  EXPECT_EQ(hold.counts().invalid_readings, 2u);
  EXPECT_FALSE(hold.convert(scan({kNan, kNan})));
  EXPECT_EQ(hold.take_warning(),
            "a sensor_msgs/LaserScan brought no reading; the channels keep what they had");

  auto skip = conversion("LaserScan", rule(NotANumber::skip), 2);
  EXPECT_TRUE(skip.convert(scan({1, 2})));
  EXPECT_FALSE(skip.convert(scan({5, kNan})));
  EXPECT_THAT(skip.channels(), ElementsAre(2, 4));
  EXPECT_EQ(skip.counts().without_reading, 1u);

  auto number = conversion("LaserScan", rule(NotANumber::number, 77), 2);
  EXPECT_TRUE(number.convert(scan({1, kNan})));
  EXPECT_THAT(number.channels(), ElementsAre(2, 77));

  auto pass = conversion("LaserScan", rule(NotANumber::pass), 2);
  EXPECT_TRUE(pass.convert(scan({1, kNan})));
  EXPECT_THAT(pass.channels(), ElementsAre(2, IsNan()));
}

TEST_P(SensorRules, elements_by_name) {
  const auto joints = message(
      "sensor_msgs/JointState",
      {{"name[0]", {}, "left_wheel"}, {"name[1]", {}, "right_wheel"}, {"position", {1.5, -2.5}}});
  auto c = conversion("sensor_msgs/JointState",
                      {.fields = {{.path = "position[name=right_wheel]", .scale = 2}}}, 1, true);
  EXPECT_TRUE(c.convert(joints));
  EXPECT_THAT(c.channels(), ElementsAre(-5));
}

TEST_P(SensorRules, elements_that_no_message_has_are_told) {
  const auto joints = [this](const std::string& name) {
    return message("sensor_msgs/JointState", {{"name[0]", {}, name}, {"position", {1.5}}});
  };
  const auto paths = plain_fields({"position[name=arm]", "position[name=hand]"});
  auto c = conversion("sensor_msgs/JointState", paths, 2, true);
  auto whole = conversion("sensor_msgs/JointState", paths, 2, true);
  for (int i = 0; i < 40; ++i) {
    c.convert(joints("arm"));
    EXPECT_EQ(c.take_warning(),
              i == 19 ? "the first 20 messages had no 'position[name=hand]', so channel 1 has no "
                        "value; give channels without a value one, as in initial: 0"
                      : "")
        << i;
    whole.convert(joints(i % 2 == 0 ? "arm" : "hand"));
    EXPECT_EQ(whole.take_warning(), "") << "two nodes publish a part each";
  }
  EXPECT_THAT(c.channels(), ElementsAre(1.5, IsNan()));
}

TEST_P(SensorRules, fields_that_are_always_nan_are_named) {
  const auto joints = [this](double velocity) {
    return message("sensor_msgs/JointState", {{"name[0]", {}, "j1"},
                                              {"name[1]", {}, "j3"},
                                              {"position", {1, 2}},
                                              {"velocity", {0.5, velocity}}});
  };
  const auto rule = [](NotANumber policy, std::vector<std::string> paths) {
    SensorRule made = plain_fields(paths);
    for (SensorField& field : made.fields) {
      field.not_a_number = policy;
    }
    return made;
  };
  const std::string always =
      "the first 20 messages had no valid value in 'velocity[name=j3]', so channel 1 has no value; "
      "select another field, or write  fields: [{path: \"velocity[name=j3]\", nan: 0}]";
  for (const NotANumber policy : {NotANumber::pass, NotANumber::hold, NotANumber::skip}) {
    auto c = conversion("sensor_msgs/JointState",
                        rule(policy, {"velocity[name=j1]", "velocity[name=j3]"}), 2, true);
    std::vector<std::string> warnings;
    for (int i = 0; i < 40; ++i) {
      c.convert(joints(kNan));
      for (auto text = c.take_warning(); !text.empty(); text = c.take_warning()) {
        warnings.push_back(text);
      }
    }
    EXPECT_EQ(warnings.size(), 1u);
    EXPECT_EQ(
        warnings.at(0),
        policy != NotANumber::skip
            ? always
            : "the first 20 messages had no valid value in 'velocity[name=j3]', so 2 channels have "
              "no value; select another field, or write  fields: [{path: \"velocity[name=j3]\", "
              "nan: 0}]");
    EXPECT_EQ(c.unread(), "");
    auto later = conversion("sensor_msgs/JointState",
                            rule(policy, {"velocity[name=j1]", "velocity[name=j3]"}), 2, true);
    for (int i = 0; i < 40; ++i) {
      later.convert(joints(i == 0 ? kNan : 3));
      EXPECT_EQ(later.take_warning(), "") << i;
    }
    EXPECT_THAT(later.channels(), ElementsAre(0.5, 3));
  }
  auto few = conversion("sensor_msgs/JointState", plain_fields({"velocity[name=j3]"}), 1, true);
  EXPECT_FALSE(few.convert(joints(kNan))) << "it does not keep the data young";
  EXPECT_TRUE(few.passes_nan());
  EXPECT_EQ(few.take_warning(), "");
  EXPECT_EQ(
      few.unread(),
      "the first message had no valid value in 'velocity[name=j3]', so channel 0 has no value; "
      "select another field, or write  fields: [{path: \"velocity[name=j3]\", nan: 0}]");
  EXPECT_TRUE(few.convert(joints(1)));
  EXPECT_EQ(few.unread(), "");
  EXPECT_FALSE(few.convert(joints(kNan)));
  EXPECT_EQ(few.take_warning(),
            "a sensor_msgs/JointState brought no reading; the channels are NaN");
  EXPECT_THAT(few.channels(), ElementsAre(IsNan()));
  EXPECT_EQ(few.counts().without_reading, 2u);

  auto hold =
      conversion("sensor_msgs/JointState", rule(NotANumber::hold, {"velocity[name=j3]"}), 1, true);
  for (int i = 0; i < 40; ++i) {
    EXPECT_FALSE(hold.convert(joints(kNan)));
    EXPECT_EQ(hold.take_warning(),
              i == 0 ? "a sensor_msgs/JointState brought no reading in 'velocity[name=j3]', so the "
                       "channels have no value"
                     : "");
  }
}

/// Joints with their positions.
std::vector<Field> joints(const std::vector<std::pair<std::string, double>>& positions) {
  std::vector<Field> fields;
  Field numbers{"position", {}};
  for (const auto& [name, position] : positions) {
    fields.push_back({"name[" + std::to_string(fields.size()) + "]", {}, name});
    numbers.numbers.push_back(position);
  }
  fields.push_back(numbers);
  return fields;
}

TEST_P(SensorRules, each_name_keeps_its_channel) {
  const std::string type = "sensor_msgs/JointState";
  auto c = conversion(type, plain_fields({"position"}), 3);
  const auto take = [&](const std::vector<std::pair<std::string, double>>& positions) {
    EXPECT_TRUE(c.convert(message(type, joints(positions))));
  };
  const auto take_names = [&](SensorConversion& into, const std::vector<std::string>& names) {
    std::vector<std::pair<std::string, double>> positions;
    for (const std::string& name : names) {
      positions.emplace_back(name, 1);
    }
    into.convert(message(type, joints(positions)));
  };
  take({{"a", 1}, {"b", 2}, {"c", 3}});
  EXPECT_THAT(c.channels(), ElementsAre(1, 2, 3));
  EXPECT_EQ(c.take_warning(), "");
  take({{"c", 30}, {"a", 10}, {"b", 20}});
  EXPECT_THAT(c.channels(), ElementsAre(10, 20, 30));
  EXPECT_EQ(c.take_warning(),
            "'name' of a sensor_msgs/JointState was [a, b, c] and is now [c, a, b]: each name "
            "keeps its channel, and new names get the next ones; select the elements by name, as "
            "in position[name=a]");
  take({{"b", 200}});
  EXPECT_THAT(c.channels(), ElementsAre(10, 200, 30));
  take({{"d", 7}, {"c", 300}});
  EXPECT_THAT(c.channels(), ElementsAre(10, 200, 300));

  EXPECT_THAT(warnings_of(c), ElementsAre(Fault("... brought 4 values ... 3 channels ... "
                                                "position[name=NAME], or write [4] ...")));
  EXPECT_EQ(c.counts().cropped, 1u);
  EXPECT_EQ(c.counts().short_messages, 0u) << "a message may have a part of the names";

  auto two = conversion(type, plain_fields({"position"}), 2);
  take_names(two, {"a", "b"});
  take_names(two, {"c"});
  take_names(two, {"a"});
  EXPECT_THAT(warnings_of(two),
              ElementsAre(Fault("... brought 3 values ... 2 channels ... [3] ...")))
      << "one warning, with the number of all names";
  EXPECT_EQ(two.counts().cropped, 1u);

  auto parts = conversion(type, plain_fields({"position"}), 3);  // two nodes publish a part each
  EXPECT_TRUE(parts.convert(message(type, joints({{"arm", 1}}))));
  EXPECT_TRUE(parts.convert(message(type, joints({{"left", 2}, {"right", 3}}))));
  EXPECT_THAT(parts.channels(), ElementsAre(1, 2, 3));
}

/// Two by two pixels: red, green, blue, white.
std::vector<Field> picture() {
  return {{"header.frame_id", {}, "camera"},
          {"height", {2}},
          {"width", {2}},
          {"encoding", {}, "rgb8"},
          {"step", {6}},
          {"is_bigendian", {0}},
          {"data", {255, 0, 0, 0, 255, 0, 0, 0, 255, 255, 255, 255}}};
}

TEST_P(SensorRules, pictures) {
  SensorRule rule;
  rule.image.emplace();
  rule.image->channel = Channel::red;
  auto c = conversion("sensor_msgs/Image", rule, 4, true);
  EXPECT_TRUE(c.convert(message("sensor_msgs/Image", picture())));
  EXPECT_THAT(c.channels(), ElementsAre(1, -1, -1, 1));
  auto grey = conversion("sensor_msgs/Image", {}, 4, true);
  EXPECT_TRUE(grey.convert(message("sensor_msgs/Image", picture())));
  EXPECT_NEAR(grey.channels()[1], 2 * 0.587 - 1, 1e-6);
}

TEST_P(SensorRules, damaged_pictures_change_nothing) {
  SensorRule rule;
  rule.image.emplace().resize = Size{1, 1};
  auto c = conversion("sensor_msgs/Image", rule, 1, true);
  const auto good = message("sensor_msgs/Image", picture());
  EXPECT_TRUE(c.convert(good));
  const double before = c.channels()[0];
  auto fields = picture();
  fields[4].numbers = {5};
  EXPECT_FALSE(c.convert(message("sensor_msgs/Image", fields)));
  EXPECT_THAT(c.take_warning(),
              Fault("a sensor_msgs/Image ... 5 bytes ... 2 pixels ... rgb8 ... 6 ... [SL0509]"));
  for (std::size_t size = 0; size < good.size(); ++size) {
    ASSERT_FALSE(c.convert(std::span(good).first(size))) << size;
  }
  EXPECT_EQ(c.counts().malformed, 1 + good.size());
  EXPECT_EQ(c.channels()[0], before);
  auto file = conversion("sensor_msgs/CompressedImage", rule, 1, true);
  EXPECT_FALSE(file.convert(
      message("sensor_msgs/CompressedImage", {{"format", {}, "jpeg"}, {"data", {255, 216, 255}}})));
  EXPECT_EQ(file.counts().malformed, 1u);
}

TEST_P(SensorRules, the_format_of_a_compressed_image_counts) {
  SensorRule rule;
  rule.image.emplace();
  auto c = conversion("sensor_msgs/CompressedImage", rule, 1);
  const auto image = [&](const char* format) {
    return message("sensor_msgs/CompressedImage", {{"format", {}, format}, {"data", {82, 73}}});
  };
  EXPECT_FALSE(c.convert(image("bgr8; jpeg compressed bgr8")));
  EXPECT_THAT(c.take_warning(), Fault("... 2 bytes ... 'bgr8; jpeg compressed bgr8' ... [SL0509]"));
  try {
    c.convert(image("h264"));
    FAIL();
  } catch (const spikeloop::ConfigurationError& error) {
    EXPECT_THAT(error.what(), Fault("... 'h264' ... [SL0511]"));
  }
}

TEST_P(SensorRules, an_unknown_encoding_ends_the_run) {
  auto c = conversion("sensor_msgs/Image", {}, 4);
  auto fields = picture();
  fields[3].text = "8UC2";
  try {
    c.convert(message("sensor_msgs/Image", fields));
    FAIL();
  } catch (const spikeloop::ConfigurationError& error) {
    EXPECT_THAT(error.what(), Fault("images ... '8UC2' ... [SL0511]"));
  }
}

TEST_P(SensorRules, pixels_without_a_reading_keep_their_channel) {
  SensorRule rule;
  rule.image.emplace().range = std::pair(0.0, 4000.0);
  auto c = conversion("sensor_msgs/Image", rule, 2);
  const auto depths = [&](double left, double right) {
    const auto low = [](double value) { return std::fmod(value, 256); };
    const auto high = [](double value) { return std::floor(value / 256); };
    return message("sensor_msgs/Image",
                   {{"height", {1}},
                    {"width", {2}},
                    {"encoding", {}, "16UC1"},
                    {"step", {4}},
                    {"data", {low(left), high(left), low(right), high(right)}}});
  };
  EXPECT_TRUE(c.convert(depths(1000, 3000)));
  EXPECT_TRUE(c.convert(depths(0, 2000)));
  EXPECT_THAT(c.channels(), ElementsAre(-0.5, 0));
  EXPECT_EQ(c.counts().invalid_readings, 1u);
}

template <typename T>
void append(std::vector<double>& bytes, T value, bool big_endian) {
  unsigned char raw[sizeof(T)];
  std::memcpy(raw, &value, sizeof(T));
  for (std::size_t i = 0; i < sizeof(T); ++i) {
    bytes.push_back(raw[big_endian ? sizeof(T) - 1 - i : i]);
  }
}

/// Two rows of three points with x (float32), a gap, ring (uint16), t (float64); rows have a gap,
/// too. Point i: x = i, ring = 1000 i, t = -i.
std::vector<Field> cloud(bool big_endian) {
  std::vector<double> data;
  for (int row = 0; row < 2; ++row) {
    for (int column = 0; column < 3; ++column) {
      const int i = 3 * row + column;
      append(data, static_cast<float>(i), big_endian);
      data.insert(data.end(), {9, 9});
      append(data, static_cast<std::uint16_t>(1000 * i), big_endian);
      append(data, static_cast<double>(-i), big_endian);
    }
    data.insert(data.end(), {7, 7, 7});
  }
  return {{"header.frame_id", {}, "lidar"},
          {"height", {2}},
          {"width", {3}},
          {"fields[0].name", {}, "x"},
          {"fields[0].datatype", {7}},
          {"fields[0].count", {1}},
          {"fields[1].name", {}, "ring"},
          {"fields[1].offset", {6}},
          {"fields[1].datatype", {4}},
          {"fields[2].name", {}, "t"},
          {"fields[2].offset", {8}},
          {"fields[2].datatype", {8}},
          {"is_bigendian", {big_endian ? 1.0 : 0.0}},
          {"point_step", {16}},
          {"row_step", {51}},
          {"data", data}};
}

TEST_P(SensorRules, points_by_the_message_s_own_fields) {
  const SensorRule rule{.fields = {{.path = "points.x[1:5]"},
                                   {.path = "points.ring[4]", .scale = 0.001},
                                   {.path = "points.t"},
                                   {.path = "width"}}};
  for (const bool big_endian : {false, true}) {
    auto c = conversion("sensor_msgs/PointCloud2", rule, 12);
    EXPECT_TRUE(c.convert(message("sensor_msgs/PointCloud2", cloud(big_endian))));
    EXPECT_THAT(c.channels(), ElementsAre(1, 2, 3, 4, DoubleEq(4), 0, -1, -2, -3, -4, -5, 3));
  }
}

TEST_P(SensorRules, clouds_that_contradict_themselves_are_refused) {
  const auto warning = [&](std::size_t field, double value, const char* path = "points.ring") {
    auto fields = cloud(false);
    fields[field].numbers = {value};
    auto c = conversion("sensor_msgs/PointCloud2", {.fields = {{.path = path}}}, 6);
    EXPECT_FALSE(c.convert(message("sensor_msgs/PointCloud2", fields)));
    EXPECT_EQ(c.counts().malformed, 1u);
    const std::string all = c.take_warning();
    return all.substr(all.find(": ") + 2);
  };
  EXPECT_EQ(warning(1, 2, "points.rings"),
            "its points have no 'rings'; did you mean 'ring'? [SL0509]");
  EXPECT_EQ(warning(8, 9), "its 'ring' has datatype 9; PointField has 1 to 8 [SL0509]");
  EXPECT_EQ(warning(7, 15), "its 'ring' at byte 15 lies outside of points of 16 bytes [SL0509]");
  EXPECT_THAT(warning(7, 4294967295.0),
              Fault("its 'ring' at byte 4294967295 ... 16 bytes ... [SL0509]"));
  EXPECT_EQ(warning(14, 47), "its rows of 47 bytes are shorter than 3 points of 16 bytes [SL0509]");
  EXPECT_EQ(warning(1, 3), "it has 102 bytes, less than 3 x 3 points of 16 bytes [SL0509]");
  EXPECT_THAT(warning(2, 4294967295.0),
              Fault("... 51 ... 4294967295 points of 16 bytes ... [SL0509]"));
  const auto good = message("sensor_msgs/PointCloud2", cloud(false));
  auto c = conversion("sensor_msgs/PointCloud2", {.fields = {{.path = "points.x"}}}, 6);
  // Of is_dense, the last byte, nothing is taken.
  for (std::size_t size = 0; size + 1 < good.size(); ++size) {
    ASSERT_FALSE(c.convert(std::span(good).first(size))) << size;
  }
}

TEST_P(SensorRules, what_is_wrong_is_said) {
  EXPECT_THAT(error_of("sensor_msgs/LaserScan", {.image = spikeloop::images::ImageSettings{}}),
              Fault("'image' is for sensor_msgs/Image and sensor_msgs/CompressedImage, not for "
                    "sensor_msgs/LaserScan; write 'fields' ... [SL0504]"));
  SensorRule small;
  small.image.emplace().resize = Size{4, 3};
  EXPECT_THAT(error_of("sensor_msgs/Image", small, 10),
              Fault("a sensor_msgs/Image gives 12 values ... 10 channels ... [12] ... [SL0505]"));
  EXPECT_THAT(
      error_of("sensor_msgs/PointCloud2", plain_fields({"points.x[2:5]"}), 2),
      Fault("a sensor_msgs/PointCloud2 gives 3 values ... 2 channels ... [3] ... [SL0505]"));
  for (const char* path :
       {"points.", "points.[1]", "points.x[]", "points.x[2", "points.x[a]", "points.x[3:3]"}) {
    EXPECT_EQ(error_of("sensor_msgs/PointCloud2", plain_fields({path})),
              "field path '" + std::string(path) +
                  "' of sensor_msgs/PointCloud2: it selects nothing; write points.NAME, "
                  "points.NAME[index] or points.NAME[first:end] [SL0504]");
  }
  EXPECT_THAT(error_of("sensor_msgs/PointCloud2", plain_fields({"points.x[0:4294967295]"})),
              Fault("field path 'points.x[0:4294967295]' of sensor_msgs/PointCloud2: "
                    "'[0:4294967295]' ... 16777216 elements ... [SL0504]"));
  EXPECT_EQ(error_of("sensor_msgs/LaserScan", plain_fields({"range"})).substr(0, 84),
            "field path 'range' of sensor_msgs/LaserScan: sensor_msgs/LaserScan has no field 'ran");
}

}  // namespace
}  // namespace sensor_rule_test
