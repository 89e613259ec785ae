#include "spikeloop/command/limiter.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "spikeloop/command/mapping.hpp"

namespace spikeloop::command::limiter_test {
namespace {

using testing::ElementsAre;

constexpr TimeNs kMs = 1'000'000;

std::vector<double> shape(Limiter& limiter, std::vector<double> values, TimeNs now) {
  const auto shaped = limiter.shape(values, now);
  return {shaped.begin(), shaped.end()};
}

TEST(Limiter, without_bounds_values_are_what_they_are) {
  Limiter limiter({}, 2);
  EXPECT_THAT(shape(limiter, {0.1, -1e300}, 0), ElementsAre(0.1, -1e300));
  EXPECT_THAT(shape(limiter, {-0.3, 1e300}, 0), ElementsAre(-0.3, 1e300));
  EXPECT_EQ(limiter.cuts(), 0U);
  EXPECT_FALSE(limiter.first_cut());
}

TEST(Limiter, minimum_and_maximum_cut_and_are_counted) {
  Limiter limiter({{-0.5, 1}}, 2);
  EXPECT_THAT(shape(limiter, {-0.75, 7}, 0), ElementsAre(-0.5, 7));
  EXPECT_THAT(shape(limiter, {1, 7}, 1), ElementsAre(1, 7)) << "a bound is within";
  EXPECT_THAT(shape(limiter, {2, 7}, 2), ElementsAre(1, 7));
  EXPECT_EQ(limiter.cuts(), 2U);
  ASSERT_TRUE(limiter.first_cut());
  EXPECT_EQ(limiter.first_cut()->component, 0U);
  EXPECT_EQ(limiter.first_cut()->value, -0.75);
}

// 2 m/s^2: 0.5 m/s is reached after 250 ms, -0.5 m/s another 500 ms later.
TEST(Limiter, slew_is_the_fastest_way_to_a_value) {
  Limiter limiter({{.slew = 2}}, 1);
  limiter.restart(std::vector<double>{0}, 100 * kMs);
  EXPECT_THAT(shape(limiter, {0.5}, 100 * kMs), ElementsAre(0));
  EXPECT_THAT(shape(limiter, {0.5}, 200 * kMs), ElementsAre(0.2));
  EXPECT_THAT(shape(limiter, {0.5}, 349 * kMs), ElementsAre(testing::DoubleEq(0.498)));
  EXPECT_THAT(shape(limiter, {0.5}, 350 * kMs), ElementsAre(0.5));
  EXPECT_THAT(shape(limiter, {-0.5}, 600 * kMs), ElementsAre(0));
  EXPECT_THAT(shape(limiter, {-0.5}, 850 * kMs), ElementsAre(-0.5));
  EXPECT_EQ(limiter.cuts(), 0U) << "the way is not a cut";
}

TEST(Limiter, after_a_stop_the_way_starts_at_zero) {
  Limiter limiter({{.slew = 1}}, 1);
  EXPECT_THAT(shape(limiter, {1}, 1000 * kMs), ElementsAre(1));
  limiter.restart(std::vector<double>{0}, 5000 * kMs);
  EXPECT_THAT(shape(limiter, {1}, 5001 * kMs), ElementsAre(0.001));
}

TEST(Limiter, after_a_stop_the_way_of_a_position_starts_where_it_is_held) {
  Limiter limiter({{.minimum = 0.5, .slew = 1, .zero_stops = false}}, 1);
  limiter.restart(std::vector<double>{0.8}, 0);
  EXPECT_THAT(shape(limiter, {1}, 100 * kMs), ElementsAre(0.9));
  const std::vector<double> zero{0};
  const bool accept_zero = true;
  EXPECT_THAT(limiter.shape(zero, 1000 * kMs, accept_zero), ElementsAre(0.5))
      << "position 0 is no stop, so that the limits apply";
}

TEST(Limiter, a_position_that_is_not_known_is_no_zero) {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  Limiter limiter({{.minimum = 0.4, .maximum = 1, .slew = 0.1}, {.slew = 1}}, 2);
  limiter.restart(std::vector{nan, 0.0}, 0);
  EXPECT_THAT(shape(limiter, {0.5, 1}, 100 * kMs), ElementsAre(0.5, 0.1));
  EXPECT_THAT(shape(limiter, {0.6, 1}, 200 * kMs), ElementsAre(testing::DoubleEq(0.51), 0.2));
}

TEST(Limiter, a_clock_that_goes_back_moves_nothing) {
  Limiter limiter({{.slew = 1}}, 1);
  EXPECT_THAT(shape(limiter, {1}, 500 * kMs), ElementsAre(0.5));
  EXPECT_THAT(shape(limiter, {1}, 400 * kMs), ElementsAre(0.5));
  EXPECT_THAT(shape(limiter, {1}, 600 * kMs), ElementsAre(0.6));
}

TEST(Limiter, random_values_never_change_faster_than_their_rates) {
  std::mt19937 engine(5);
  std::uniform_real_distribution<double> value(-3, 3);
  std::uniform_int_distribution<TimeNs> wait(0, 20 * kMs);
  const std::vector<Bounds> bounds = {{-1, 1, 4}, {0, 2, 0.5}};
  Limiter limiter(bounds, 2);
  std::vector<double> before = {0, 0};
  TimeNs now = 0;
  for (int i = 0; i < 20000; ++i) {
    const TimeNs step = wait(engine);
    now += step;
    const auto shaped = shape(limiter, {value(engine), value(engine)}, now);
    for (std::size_t c = 0; c < 2; ++c) {
      ASSERT_LE(std::fabs(shaped[c] - before[c]), bounds[c].slew * to_seconds(step) + 1e-12);
      ASSERT_GE(shaped[c], bounds[c].minimum);
      ASSERT_LE(shaped[c], bounds[c].maximum);
    }
    before = shaped;
  }
}

TEST(DefaultBounds, velocities_have_them_and_other_messages_not) {
  for (const char* message : {"geometry_msgs/Twist", "geometry_msgs/TwistStamped"}) {
    const std::string within = std::string(message).ends_with("Stamped") ? "twist." : "";
    EXPECT_EQ(default_bounds(message, within + "linear.y").maximum, 1) << message;
    EXPECT_EQ(default_bounds(message, within + "linear.x").minimum, -1) << message;
    EXPECT_EQ(default_bounds(message, within + "angular.z").maximum, 3) << message;
    EXPECT_TRUE(std::isinf(default_bounds(message, within + "angular.z").slew)) << message;
  }
  EXPECT_TRUE(std::isinf(default_bounds("geometry_msgs/TwistStamped", "header.stamp").maximum));
  EXPECT_TRUE(std::isinf(default_bounds("std_msgs/Float64MultiArray", "linear.x").maximum));
}

TEST(DefaultBounds, a_limit_of_the_mapping_stands) {
  CommandMapping mapping{.file = "", .message_type = "geometry_msgs/Twist"};
  mapping.fields = {{.field = "linear.x", .channel = 0, .maximum = 5, .slew = 2},
                    {.field = "angular.z", .channel = 1, .slew = 7}};
  const auto bounds = command::bounds(mapping, 2, true);
  ASSERT_EQ(bounds.size(), 2U);
  EXPECT_TRUE(std::isinf(bounds[0].minimum));
  EXPECT_EQ(bounds[0].maximum, 5);
  EXPECT_EQ(bounds[0].slew, 2);
  EXPECT_EQ(bounds[1].minimum, -3);
  EXPECT_EQ(bounds[1].maximum, 3);
  EXPECT_EQ(bounds[1].slew, 7);
}

}  // namespace
}  // namespace spikeloop::command::limiter_test
