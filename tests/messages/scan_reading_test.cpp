// Beams of a LaserScan: their order, and resampling by angle. The oracle compares angles of single
// beams by their cosine and sine, without the index arithmetic of the implementation.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include "spikeloop/core/error.hpp"
#include "spikeloop/messages/message_writer.hpp"
#include "spikeloop/messages/sensor_conversion.hpp"
#include "tests/support/error_of.hpp"

namespace scan_reading_test {
namespace {

using namespace spikeloop::messages;
using spikeloop::test::error_of;
using spikeloop::test::Fault;
using testing::DoubleNear;
using testing::Each;
using testing::ElementsAre;
using testing::IsNan;
using testing::Pointwise;

constexpr double kPi = std::numbers::pi;
constexpr double kDegree = kPi / 180;
constexpr double kInf = std::numeric_limits<double>::infinity();
const double kNan = std::nan("");

struct Scan {
  std::vector<double> ranges{};
  double angle_min = 0;
  double increment = 0;
  double angle_max = 0;
  double least = 0;
  double most = 10;
};

class ScanReadings : public testing::TestWithParam<Dialect> {
 protected:
  const Catalog& catalog() const { return Catalog::builtin(GetParam()); }

  std::vector<std::byte> message(const Scan& scan) const {
    const std::vector<std::vector<double>> numbers{{scan.angle_min}, {scan.increment},
                                                   {scan.angle_max}, {scan.least},
                                                   {scan.most},      scan.ranges};
    std::vector<FieldValue> values;
    for (const auto& each : numbers) {
      values.push_back({each, {}});
    }
    std::vector<std::byte> bytes;
    MessageWriter(catalog(), "sensor_msgs/LaserScan",
                  {"angle_min", "angle_increment", "angle_max", "range_min", "range_max", "ranges"})
        .write(values, bytes);
    return bytes;
  }

  SensorConversion conversion(std::uint32_t width, const ScanRule& rule = {}) const {
    return {catalog(), "sensor_msgs/LaserScan", {.scan = rule}, width, false};
  }

  /// Channels after one scan.
  std::vector<double> channels(const Scan& scan, std::uint32_t width,
                               const ScanRule& rule = {}) const {
    SensorConversion c = conversion(width, rule);
    c.convert(message(scan));
    return {c.channels().begin(), c.channels().end()};
  }
};

INSTANTIATE_TEST_SUITE_P(Dialects, ScanReadings, testing::Values(Dialect::ros1, Dialect::ros2),
                         [](const auto& dialect) {
                           return dialect.param == Dialect::ros1 ? "ros1" : "ros2";
                         });

/// A value in [-1, 1] for range_min 0 and range_max 10.
double value(double range) {
  return range / 5 - 1;
}

/// Smallest angle between two directions.
double angle_between(double a, double b) {
  return std::abs(std::atan2(std::sin(a - b), std::cos(a - b)));
}

/// NaN: no value.
double expected(const Scan& scan, double direction, double half_width) {
  double least = kInf;
  double nearest = kInf;
  double nearest_range = kNan;
  for (std::size_t k = 0; k < scan.ranges.size(); ++k) {
    const double beam = scan.angle_min + static_cast<double>(k) * scan.increment;
    const double distance = angle_between(beam, direction);
    if (distance < half_width + 1e-3 * std::abs(scan.increment)) {
      least = std::min(least, scan.ranges[k]);
    }
    if (distance < nearest) {
      nearest = distance;
      nearest_range = scan.ranges[k];
    }
  }
  if (least < kInf) {
    return value(least);
  }
  return nearest < 1.001 * std::abs(scan.increment) ? value(nearest_range) : kNan;
}

TEST_P(ScanReadings, resampled_values_are_the_nearest_obstacles_of_their_directions) {
  std::mt19937 random(7);
  const auto uniform = [&](double low, double high) {
    return std::uniform_real_distribution<>(low, high)(random);
  };
  for (int trial = 0; trial < 300; ++trial) {
    const auto beams = static_cast<std::size_t>(uniform(2, 400));
    const double field = uniform(0.2, 2 * kPi);
    const double sign = trial % 2 == 0 ? 1 : -1;
    Scan scan{.angle_min = static_cast<float>(uniform(-2 * kPi, 2 * kPi)),
              .increment = static_cast<float>(sign * field / static_cast<double>(beams))};
    for (std::size_t i = 0; i < beams; ++i) {
      scan.ranges.push_back(static_cast<float>(uniform(0.1, 9.9)));
    }
    const auto count = static_cast<std::uint32_t>(uniform(1, 120));
    const double first = uniform(-2 * kPi, 0.5 * kPi);
    const double last = uniform(first + 0.05, std::min(first + 2 * kPi, 2 * kPi));
    const auto found = channels(scan, count, {.beams = count, .angles = std::pair(first, last)});
    const double spacing = count == 1 ? last - first : (last - first) / (count - 1);
    for (std::uint32_t i = 0; i < count; ++i) {
      const double direction = count == 1 ? (first + last) / 2 : first + i * spacing;
      const double wanted = expected(scan, direction, spacing / 2);
      EXPECT_TRUE(std::isnan(wanted) ? std::isnan(found[i]) : std::abs(found[i] - wanted) < 1e-6)
          << "trial " << trial << " channel " << i << ": " << found[i] << ", not " << wanted;
    }
  }
}

TEST_P(ScanReadings, a_scan_that_fits_keeps_its_values) {
  Scan scan{.angle_min = -1.5, .increment = 0.03};
  for (int i = 0; i < 100; ++i) {
    scan.ranges.push_back(0.5 + 0.09 * i);
  }
  const auto plain = channels(scan, 100);
  EXPECT_EQ(channels(scan, 100, {.beams = 100}), plain);
  EXPECT_THAT(channels(scan, 100, {.beams = 100, .angles = std::pair(-1.5, -1.5 + 99 * 0.03)}),
              Pointwise(DoubleNear(1e-12), plain));
}

TEST_P(ScanReadings, scans_of_any_length_give_the_same_scene) {
  // A wall 2 m ahead, as lidars with 359 to 361 and 453 to 460 beams see it.
  for (const int beams : {359, 360, 361, 453, 460}) {
    Scan scan{.angle_min = -kPi / 2, .increment = kPi / (beams - 1)};
    for (int i = 0; i < beams; ++i) {
      const double angle = -kPi / 2 + i * scan.increment;
      scan.ranges.push_back(std::min(2 / std::max(std::cos(angle), 1e-9), 9.0));
    }
    auto c = conversion(19, {.beams = 19, .angles = std::pair(-60 * kDegree, 60 * kDegree)});
    EXPECT_TRUE(c.convert(message(scan)));
    EXPECT_EQ(c.take_warning(), "");
    for (int i = 0; i < 19; ++i) {
      // The nearest point of the wall in the sector, at most a beam from its edge.
      const double edge = std::max(0.0, std::abs(-60 + 120.0 / 18 * i) - 60.0 / 18) * kDegree;
      EXPECT_NEAR(c.channels()[static_cast<std::size_t>(i)], value(2 / std::cos(edge)), 0.02)
          << beams << " beams, channel " << i;
    }
  }
}

TEST_P(ScanReadings, beams_without_a_reading_do_not_count) {
  auto c = conversion(3, {.beams = 3});  // of seven beams: 0 and 1, 2 to 4, 5 and 6
  EXPECT_TRUE(c.convert(message({.ranges = {kNan, 3, 0, kInf, kNan, 4, 5}})));
  EXPECT_THAT(c.channels(), ElementsAre(DoubleNear(value(3), 1e-6), 1, DoubleNear(value(4), 1e-6)));
  EXPECT_TRUE(c.convert(message({.ranges = {kNan, 0, 1, kInf, kNan, kNan, 0}})));
  EXPECT_THAT(c.channels(), ElementsAre(DoubleNear(value(3), 1e-6), DoubleNear(value(1), 1e-6),
                                        DoubleNear(value(4), 1e-6)));
  EXPECT_EQ(c.counts().invalid_readings, 2u);
}

TEST_P(ScanReadings, a_direction_without_a_beam_keeps_its_value) {
  const Scan quarter{.ranges = {1, 2, 3, 4}, .angle_min = 0, .increment = 30 * kDegree};
  auto c = conversion(4, {.beams = 4, .angles = std::pair(0.0, 180 * kDegree)});
  EXPECT_TRUE(c.convert(message(quarter)));
  EXPECT_THAT(c.channels(), ElementsAre(DoubleNear(value(1), 1e-6), DoubleNear(value(2), 1e-6),
                                        DoubleNear(value(4), 1e-6), IsNan()));
  for (int i = 0; i < 19; ++i) {
    c.convert(message(quarter));
  }
  EXPECT_EQ(
      c.take_warning(),
      "the first 20 messages had no 'beam at 180 deg', so channel 3 has no value; give channels "
      "without a value one, as in initial: -1, an obstacle");
}

TEST_P(ScanReadings, channel_0_is_the_rightmost_beam) {
  const Scan right_to_left{
      .ranges = {1, 2, 3}, .angle_min = -1, .increment = 1, .angle_max = 1, .most = 10};
  const auto wanted = ElementsAre(DoubleNear(value(1), 1e-6), DoubleNear(value(2), 1e-6),
                                  DoubleNear(value(3), 1e-6));
  EXPECT_THAT(channels(right_to_left, 3), wanted);
  Scan clockwise{.ranges = {3, 2, 1}, .angle_min = 1, .increment = -1, .angle_max = -1};
  EXPECT_THAT(channels(clockwise, 3), wanted);
  EXPECT_THAT(channels(clockwise, 3, {.beams = 3}), wanted);
  EXPECT_THAT(channels(clockwise, 3, {.beams = 3, .angles = std::pair(-1.0, 1.0)}), wanted);
  // Without an increment the limits determine the direction.
  for (const double none : {0.0, kNan}) {
    clockwise.increment = none;
    EXPECT_THAT(channels(clockwise, 3), wanted) << none;
    EXPECT_THAT(channels(clockwise, 3, {.beams = 3, .angles = std::pair(-1.0, 1.0)}), wanted);
  }
  // Across the back angle_max is the smaller one, although the beams go to the left.
  EXPECT_THAT(
      channels({.ranges = {1, 2, 3}, .angle_min = 2.6, .increment = 0.5, .angle_max = -2.7}, 3),
      wanted);
}

TEST_P(ScanReadings, paths_keep_the_order_of_the_message_with_a_warning) {
  SensorConversion c(catalog(), "sensor_msgs/LaserScan", plain_fields({"ranges[0:2]", "range_max"}),
                     3, true);
  EXPECT_TRUE(c.convert(message({.ranges = {3, 2, 1}, .increment = 1})));
  EXPECT_EQ(c.take_warning(), "");
  for (const char* warning :
       {"angle_increment of a sensor_msgs/LaserScan is -1: 'fields' reads its "
        "beams from left to right, as they are in the message; leave out "
        "'fields' to read them from right to left",
        ""}) {
    EXPECT_TRUE(c.convert(message({.ranges = {3, 2, 1}, .increment = -1})));
    EXPECT_THAT(c.channels(), ElementsAre(3, 2, 10));
    EXPECT_EQ(c.take_warning(), warning);
  }
}

TEST_P(ScanReadings, a_circle_has_no_seam) {
  // 0 to 360 degrees, as a TurtleBot3 has it: the front is at both ends.
  Scan scan{.ranges = std::vector<double>(360, 8), .angle_min = 0, .increment = kDegree};
  scan.ranges[358] = 1;
  scan.ranges[3] = 2;
  const auto front =
      channels(scan, 3, {.beams = 3, .angles = std::pair(-4 * kDegree, 4 * kDegree)});
  EXPECT_THAT(front, ElementsAre(DoubleNear(value(1), 1e-6), DoubleNear(value(1), 1e-6),
                                 DoubleNear(value(2), 1e-6)));
  EXPECT_THAT(channels(scan, 3, {.beams = 3, .angles = std::pair(-364 * kDegree, -356 * kDegree)}),
              Pointwise(DoubleNear(1e-12), front));
}

TEST_P(ScanReadings, scans_without_angles_are_refused_if_angles_are_needed) {
  const ScanRule rule{.beams = 3, .angles = std::pair(-1.0, 1.0)};
  for (const double increment : {0.0, kNan, kInf, 40.0, 1e30}) {
    auto c = conversion(3, rule);
    EXPECT_FALSE(c.convert(message({.ranges = {1, 2, 3}, .increment = increment})));
    EXPECT_THAT(c.take_warning(), Fault("... angle_min 0 ... angle_increment ... 'angles' ..."))
        << increment;
    EXPECT_THAT(channels({.ranges = {1, 2, 3}, .increment = increment}, 3, {.beams = 3}),
                Each(testing::Ge(-1)));
  }
  // At this angle, adding the increment changes no float32: the conversion must not hang.
  for (const double far : {1e30, -1e30}) {
    auto c = conversion(3, rule);
    EXPECT_TRUE(c.convert(message({.ranges = {1, 2, 3}, .angle_min = far, .increment = 2})));
  }
  auto empty = conversion(3, rule);
  EXPECT_FALSE(empty.convert(message({})));
  EXPECT_EQ(empty.counts().malformed, 0u);
  EXPECT_EQ(empty.counts().without_reading, 1u);
}

TEST_P(ScanReadings, limits_that_a_driver_has_not_set_are_replaced) {
  struct Case {
    double least;
    double most;
    double used_least;
    double used_most;
  };
  constexpr double kLargest = std::numeric_limits<float>::max();
  for (const Case& each : {Case{0, kInf, 0, 10}, Case{0.5, kInf, 0.5, 10}, Case{0, kLargest, 0, 10},
                           Case{0, kNan, 0, 10}, Case{0, 0, 0, 10}, Case{kNan, 5, 0, 5},
                           Case{-kInf, kInf, 0, 10}, Case{kInf, 5, 0, 5}, Case{-1, 5, 0, 5}}) {
    auto c = conversion(4);
    const Scan scan{.ranges = {2, 0, kInf, 20}, .least = each.least, .most = each.most};
    EXPECT_TRUE(c.convert(message(scan)));
    const double span = each.used_most - each.used_least;
    EXPECT_THAT(c.channels(),
                ElementsAre(DoubleNear(2 * (2 - each.used_least) / span - 1, 1e-6), IsNan(), 1, 1))
        << each.least << " " << each.most;
    EXPECT_EQ(c.take_warning(),
              fmt::format("a sensor_msgs/LaserScan has range_min {0:g} and range_max {1:g}, so the "
                          "range is taken as {2:g} m to {3:g} m; set the sensor's key 'range' to "
                          "the limits in metres, as in [{2:g}, {3:g}]",
                          static_cast<float>(each.least), static_cast<float>(each.most),
                          each.used_least, each.used_most));
    EXPECT_TRUE(c.convert(message(scan)));
    EXPECT_EQ(c.take_warning(), "");
    EXPECT_THAT(channels(scan, 4, {.range = std::pair(1.0, 3.0)}), ElementsAre(0, IsNan(), 1, 1));
  }
  for (const auto& [least, most] : {std::pair(4.0, 4.0), std::pair(12.0, kInf)}) {
    auto c = conversion(1);
    EXPECT_FALSE(c.convert(message({.ranges = {2}, .least = least, .most = most})));
    EXPECT_THAT(c.take_warning(), Fault("... range_min ... range_max ... 'range' ... [0, 10] ..."));
  }
  auto far = conversion(1);
  EXPECT_TRUE(far.convert(message({.ranges = {2500}, .most = 10000})));
  EXPECT_EQ(far.take_warning(), "");
  EXPECT_THAT(far.channels(), ElementsAre(-0.5));
}

TEST_P(ScanReadings, resampling_is_for_scans) {
  EXPECT_THAT(error_of([&] {
                SensorConversion(catalog(), "nav_msgs/Odometry", {.scan = ScanRule{.beams = 3}}, 3,
                                 true);
              }),
              Fault("'beams', 'angles' and 'range' are for sensor_msgs/LaserScan, not for "
                    "nav_msgs/Odometry; leave them out ... [SL0504]"));
  EXPECT_THAT(error_of([&] {
                SensorConversion(catalog(), "sensor_msgs/Image", {.scan = ScanRule{}}, 3, true);
              }),
              Fault("... write the range of an image as  image: {range: [300, 5000]} [SL0504]"));
}

}  // namespace
}  // namespace scan_reading_test
