// Channels without a valid value, and the single warning about them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/messages/sensor_rules.hpp"
#include "tests/support/fault.hpp"

namespace missing_values_test {
namespace {

using namespace spikeloop::messages;
using sensor_rule_test::warnings_of;
using spikeloop::test::Fault;
using testing::ElementsAre;
using testing::IsNan;

const double kNan = std::nan("");

class MissingValues : public sensor_rule_test::SensorRules {};

INSTANTIATE_TEST_SUITE_P(Dialects, MissingValues, testing::Values(Dialect::ros1, Dialect::ros2),
                         [](const auto& dialect) {
                           return dialect.param == Dialect::ros1 ? "ros1" : "ros2";
                         });

TEST_P(MissingValues, a_channel_keeps_initial_until_its_first_value) {
  for (const NotANumber policy : {NotANumber::pass, NotANumber::hold}) {
    const SensorRule rule{.fields = {{.path = "ranges", .not_a_number = policy}}};
    SensorConversion c(catalog(), "LaserScan", rule, 3, false, 0.5);
    EXPECT_THAT(c.channels(), ElementsAre(0.5, 0.5, 0.5));
    EXPECT_TRUE(c.convert(scan({1, kNan, kNan})));
    EXPECT_THAT(c.channels(), ElementsAre(1, 0.5, 0.5));
    EXPECT_FALSE(c.passes_nan());
    EXPECT_FALSE(c.convert(scan({kNan, kNan, kNan}))) << "it does not keep the data young";
    EXPECT_THAT(
        c.channels(),
        ElementsAre(policy == NotANumber::pass ? testing::Matcher<double>(IsNan()) : 1, 0.5, 0.5))
        << "after a value, NaN is passed on";
    c.take_warning();
    EXPECT_TRUE(c.convert(scan({1, 2, kNan})));
    EXPECT_EQ(c.unread(),
              "the first 3 messages had no valid value in 'ranges[2]', so channel 2 keeps its "
              "initial value 0.5");
  }
}

TEST_P(MissingValues, blind_beams_and_pixels_are_named_once_with_a_remedy) {
  auto beams = conversion("LaserScan", {.scan = ScanRule{.range = std::pair(0.0, 10.0)}}, 4);
  auto slice = conversion("LaserScan", plain_fields({"ranges[10:]"}), 2);
  SensorRule depth;
  depth.image.emplace().range = std::pair(0.0, 100.0);
  auto pixels = conversion("sensor_msgs/Image", depth, 6, true);
  const auto image = message("sensor_msgs/Image", {{"height", {2}},
                                                   {"width", {3}},
                                                   {"encoding", {}, "16UC1"},
                                                   {"step", {6}},
                                                   {"data", {9, 0, 9, 0, 9, 0, 9, 0, 9, 0, 0, 0}}});
  std::vector<double> ranges(12, 1.0);
  ranges[11] = kNan;
  for (int i = 0; i < 40; ++i) {
    EXPECT_TRUE(beams.convert(scan({5, 0, 5, kNan})));
    EXPECT_TRUE(slice.convert(scan(ranges)));
    EXPECT_TRUE(pixels.convert(image));
  }
  EXPECT_THAT(beams.channels(), ElementsAre(0, IsNan(), 0, IsNan()));
  EXPECT_THAT(warnings_of(beams),
              ElementsAre("the first 20 messages had no valid value in 'ranges[1]', so 2 channels "
                          "have no value, the first is channel 1; give channels without a value "
                          "one, as in initial: -1, an obstacle"));
  EXPECT_THAT(
      warnings_of(slice),
      ElementsAre(Fault("... 'ranges[11]', so channel 1 ... {path: \"ranges[10:]\", nan: 0}]")));
  EXPECT_THAT(
      warnings_of(pixels),
      ElementsAre(Fault("... 'pixel (2, 1)', so channel 5 has no value; ... as in initial: 0")));
}

TEST_P(MissingValues, a_channel_with_an_earlier_value_is_not_reported) {
  for (const int good : {0, 7, 18}) {
    auto c = conversion("LaserScan", plain_fields({"ranges[0]", "ranges[1]"}), 2, true);
    for (int i = 0; i < 20; ++i) {
      c.convert(scan({1, i == good ? 2 : kNan}));
    }
    EXPECT_THAT(warnings_of(c), ElementsAre()) << good;
  }
  const SensorField skip{.path = "ranges", .not_a_number = NotANumber::skip};
  auto c = conversion("LaserScan", {.fields = {skip}}, 2);
  for (int i = 0; i < 20; ++i) {
    EXPECT_FALSE(c.convert(i % 2 == 0 ? scan({1, kNan}) : scan({kNan, 1})));
  }
  EXPECT_THAT(warnings_of(c),
              ElementsAre("the first 20 messages were left out, because each had NaN in a field "
                          "with nan: skip; replace NaN, as in nan: 0"));
}

TEST_P(MissingValues, fields_can_determine_the_width_without_a_message) {
  const auto count = [&](std::string_view type, const SensorRule& rule, const auto& bytes) {
    return SensorConversion::count(catalog(), type, rule, bytes);
  };
  const SensorField skip{.path = "ranges[2:5]", .not_a_number = NotANumber::skip};
  EXPECT_EQ(count("LaserScan", {.fields = {skip}}, scan({kNan})), 3u);
  EXPECT_EQ(count("LaserScan", plain_fields({"ranges"}), scan({})), 0u);
  EXPECT_EQ(count("LaserScan", plain_fields({"ranges"}), scan({kNan, kNan})), 2u);
  EXPECT_EQ(count("Odometry", {}, message("nav_msgs/Odometry", {})), 3u);
}

}  // namespace
}  // namespace missing_values_test
