// Distance and angle to a centre line, against geometry with complex numbers; the start
// on a lane.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <set>

#include "worlds.hpp"

namespace spikeloop::vehicle::lane_test {
namespace {

using Point = std::complex<double>;

struct Box {
  Point centre;
  double half_x;
  double half_y;
  double degrees;
};

std::string geom(const Box& box, int number) {
  return fmt::format(
      R"(<geom name="lane_{}" type="box" size="{} {} 0.002" pos="{} {} 0.002" euler="0 0 {}"
          contype="0" conaffinity="0"/>)",
      number, box.half_x, box.half_y, box.centre.real(), box.centre.imag(), box.degrees);
}

std::string world_of(const std::vector<Box>& boxes, const std::string& numerics) {
  std::string bodies = kFloor;
  for (std::size_t i = 0; i < boxes.size(); ++i) bodies += geom(boxes[i], static_cast<int>(i));
  return mjcf(kArena + numerics, bodies);
}

/// The point relative to the box, whose longer sides are along the real axis.
Point relative(const Box& box, Point at) {
  const Point turned = (at - box.centre) * std::polar(1.0, -box.degrees * std::numbers::pi / 180);
  return box.half_x >= box.half_y ? turned : turned * Point(0, -1);
}

/// The distance from the centre line, found by looking at many of its points.
double searched_distance(const Box& box, Point at) {
  const double half = std::max(box.half_x, box.half_y);
  const Point here = relative(box, at);
  double least = 1e9;
  for (int i = -5000; i <= 5000; ++i) {
    least = std::min(least, std::abs(here - half * i / 5000.0));
  }
  return least;
}

const std::vector<Box> kBoxes{{{1, 1}, 0.8, 0.2, 30},
                              {{-1, 1}, 0.15, 0.9, 20},  // its longer sides are along its y axis
                              {{-1.2, -1.3}, 0.7, 0.3, -100},
                              {{1.5, -1}, 0.5, 0.25, 170},
                              {{1.1, 1.2}, 0.4, 0.05, 30}};  // a narrow one inside the first

TEST(Lane, DistanceAndAngleAreThoseOfTheLaneThatIsNearestForItsWidth) {
  const std::vector<Pose> poses{{0.9, 1.2, 0.4},     {0.9, 1.2, 0.4 + std::numbers::pi},
                                {1.9, 1.3, -2.0},    {-1.1, 0.6, 1.5},
                                {-0.9, 0.6, -1.2},   {-1.3, 1.95, 2.6},
                                {-1.0, -1.2, -1.75}, {-1.5, -0.4, 0.1},
                                {1.5, -0.9, 3.0},    {2.2, -1.1, -0.3},
                                {0.1, -0.2, 0.7}};
  for (const Pose& pose : poses) {
    const World world(world_of(kBoxes, fmt::format(R"(<numeric name="start" data="{} {} {}"/>)",
                                                   pose.x_m, pose.y_m, pose.theta_rad)));
    const Vehicle vehicle = world.vehicle();
    ASSERT_EQ(vehicle.lanes().size(), kBoxes.size());
    const LanePosition position = *vehicle.lane_position();
    const Point at(pose.x_m, pose.y_m);
    const Box* nearest = nullptr;
    double least = 1e9;
    for (const Box& box : kBoxes) {
      const double widths = searched_distance(box, at) / std::min(box.half_x, box.half_y);
      if (widths < least) {
        least = widths;
        nearest = &box;
      }
    }
    EXPECT_NEAR(std::abs(position.distance_m), searched_distance(*nearest, at), 1e-6);
    EXPECT_EQ(position.half_width_m, std::min(nearest->half_x, nearest->half_y));
    EXPECT_EQ(position.is_inside(), least <= 1);
    // The heading relative to the line: ahead has a positive real part in one of its directions.
    Point ahead = relative(*nearest, at + std::polar(1.0, pose.theta_rad)) - relative(*nearest, at);
    Point here = relative(*nearest, at);
    if (ahead.real() < 0) {
      ahead = -ahead;
      here = -here;
    }
    EXPECT_NEAR(position.angle_rad, std::arg(ahead), 1e-9);
    EXPECT_EQ(position.distance_m > 0, here.imag() > 0) << pose.x_m << " " << pose.y_m;
  }
}

TEST(Lane, AWorldWithoutOneHasNone) {
  EXPECT_FALSE(World(kArena + kStart, kFloor).vehicle().lane_position());
}

TEST(Lane, IsNoObstacle) {
  const World world(world_of({{{0, 0}, 2.5, 0.3, 0}}, R"(<numeric name="start" data="-2 0 0"/>)"));
  Vehicle vehicle = world.vehicle();
  vehicle.command(0.5, 0);
  vehicle.step(6 * kSecond);
  EXPECT_GT(vehicle.pose().x_m, 0.8);
  EXPECT_EQ(vehicle.statistics().collisions, 0U);
  EXPECT_NEAR(vehicle.lane_position()->distance_m, vehicle.pose().y_m, 1e-12);
}

TEST(Lane, TheSeedDrawsAStartOnItAwayFromItsEnds) {
  // A bend: the lane ends at the box's left end and at the upper end of the other one.
  const World world(world_of({{{0, 0}, 2, 0.2, 0}, {{2, 1}, 1, 0.2, 90}},
                             R"(<numeric name="start_clearance" data="0.5"/>)"));
  std::set<double> places;
  int upward = 0;
  int back = 0;
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    const Vehicle vehicle = world.vehicle(seed);
    const Pose start = vehicle.pose();
    EXPECT_NEAR(vehicle.lane_position()->distance_m, 0, 1e-9) << seed;
    EXPECT_NEAR(vehicle.lane_position()->angle_rad, 0, 1e-9) << seed;
    // The end of the lane is half a circle of its half width around the end of its centre line.
    EXPECT_GE(start.x_m, -2 - 0.2 + 0.5 - 1e-9);
    EXPECT_LE(start.y_m, 2 + 0.2 - 0.5 + 1e-9);
    places.insert(start.x_m + start.y_m);
    upward += start.y_m > 1e-6;
    back += std::cos(start.theta_rad) + std::sin(start.theta_rad) < 0;
  }
  EXPECT_EQ(places.size(), 60U);
  EXPECT_GT(upward, 10);  // a third of the length
  EXPECT_LT(upward, 30);
  EXPECT_GT(back, 15);
  EXPECT_LT(back, 45);
}

/// A controller steers by distance and angle. The seeds start in different directions.
TEST(ShippedWorlds, TheLaneIsClosedAndCanBeDrivenInBothDirections) {
  std::set<bool> directions;
  for (const std::uint64_t seed : {5U, 6U}) {
    Vehicle vehicle({"lane", seed});
    double turned_left = 0;
    double turned_right = 0;
    for (int i = 0; i < 760; ++i) {
      const LanePosition position = *vehicle.lane_position();
      ASSERT_LT(std::abs(position.distance_m), 0.2) << "seed " << seed << ", step " << i;
      vehicle.command(0.4, -6 * position.distance_m - 3 * position.angle_rad);
      const double before = vehicle.pose().theta_rad;
      vehicle.step(50 * kMs);
      const double turn = turned(before, vehicle.pose().theta_rad);
      (turn > 0 ? turned_left : turned_right) += std::abs(turn);
    }
    // 15.2 m: more than once around, with curves of 270 degrees to one side and 90 to the other.
    EXPECT_GT(std::abs(turned_left - turned_right), 5.5) << seed;
    directions.insert(turned_left > turned_right);
    EXPECT_GT(std::min(turned_left, turned_right), 1.2) << seed;
    EXPECT_EQ(vehicle.statistics().collisions, 0U);
  }
  EXPECT_EQ(directions.size(), 2U);
}

}  // namespace
}  // namespace spikeloop::vehicle::lane_test
