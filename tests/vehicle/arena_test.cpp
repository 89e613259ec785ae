// The layout drawn from the seed, coverage and collisions.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <filesystem>
#include <set>

#include "worlds.hpp"

namespace spikeloop::vehicle {
namespace {

// Points on and inside a footprint's outline, worked out here.
std::vector<std::array<double, 2>> outline(const Obstacle& o) {
  std::vector<std::array<double, 2>> points;
  constexpr int kPoints = 100;
  for (int i = 0; i < kPoints; ++i) {
    const double angle = 2 * std::numbers::pi * i / kPoints;
    double x = std::cos(angle);
    double y = std::sin(angle);
    if (o.shape == Obstacle::Shape::cylinder) {
      points.push_back({o.x_m + o.radius_m * x, o.y_m + o.radius_m * y});
      continue;
    }
    const double stretch = 1 / std::max(std::abs(x), std::abs(y));  // onto the unit square
    x *= stretch * o.half_x_m;
    y *= stretch * o.half_y_m;
    points.push_back({o.x_m + std::cos(o.theta_rad) * x - std::sin(o.theta_rad) * y,
                      o.y_m + std::sin(o.theta_rad) * x + std::cos(o.theta_rad) * y});
  }
  return points;
}

double gap(const Obstacle& a, const Obstacle& b) {
  double nearest = 1e9;
  const auto others = outline(b);
  for (const auto& p : outline(a)) {
    for (const auto& q : others) nearest = std::min(nearest, std::hypot(p[0] - q[0], p[1] - q[1]));
  }
  return nearest;
}

TEST(Layout, PassagesAreOpenAndTheStartIsFreeForFiftySeeds) {
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    const Vehicle vehicle({"arena.xml", seed});
    const auto& obstacles = vehicle.obstacles();
    ASSERT_GE(obstacles.size(), 6U);
    const Pose start = vehicle.pose();
    EXPECT_LE(std::max(std::abs(start.x_m), std::abs(start.y_m)), 3 - vehicle.radius_m());
    for (std::size_t i = 0; i < obstacles.size(); ++i) {
      for (std::size_t j = i + 1; j < obstacles.size(); ++j) {
        EXPECT_GE(gap(obstacles[i], obstacles[j]), 0.9) << "seed " << seed;
      }
      for (const auto& [x, y] : outline(obstacles[i])) {
        EXPECT_LE(std::max(std::abs(x), std::abs(y)), 3 - 0.9) << "seed " << seed;
        EXPECT_GE(std::hypot(x - start.x_m, y - start.y_m), vehicle.radius_m() + 0.1)
            << "seed " << seed;
      }
    }
  }
}

TEST(Layout, SeedsGiveDifferentPlacesAndHeadings) {
  std::set<std::pair<double, double>> starts;
  std::set<double> headings;
  std::set<double> places;
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    const Vehicle vehicle({"arena.xml", seed});
    starts.emplace(vehicle.pose().x_m, vehicle.pose().y_m);
    headings.insert(vehicle.pose().theta_rad);
    places.insert(vehicle.obstacles()[0].x_m);
  }
  EXPECT_EQ(starts.size(), 50U);
  EXPECT_EQ(headings.size(), 50U);
  EXPECT_EQ(places.size(), 50U);
}

TEST(Layout, AFixedWorldIsTheSameForEverySeed) {
  const World world(kArena + R"(<numeric name="start" data="-1 0.5 0.3"/>)",
                    kFloor + kWalls +
                        R"(<body name="obstacle_a" pos="1 1 0.2" euler="0 0 90">
                             <geom type="box" size="0.3 0.1 0.2"/></body>
                           <body name="obstacle_b" pos="-1 -1 0.2">
                             <geom type="cylinder" size="0.4 0.2"/></body>)");
  for (const std::uint64_t seed : {1U, 2U}) {
    const Vehicle vehicle = world.vehicle(seed);
    EXPECT_NEAR(vehicle.pose().x_m, -1, 1e-9);
    EXPECT_NEAR(vehicle.pose().y_m, 0.5, 1e-9);
    EXPECT_NEAR(vehicle.pose().theta_rad, 0.3, 1e-9);
    ASSERT_EQ(vehicle.obstacles().size(), 2U);
    const Obstacle& box = vehicle.obstacles()[0];
    EXPECT_EQ(box.name, "obstacle_a");
    EXPECT_NEAR(box.theta_rad, std::numbers::pi / 2, 1e-9);
    EXPECT_NEAR(box.distance_m(1, 1), 0, 1e-12);
    EXPECT_NEAR(box.distance_m(1, 1.4), 0.1, 1e-9);  // turned: half length 0.3 lies along y
    EXPECT_NEAR(box.distance_m(1.3, 1), 0.2, 1e-9);
    EXPECT_NEAR(box.distance_m(1.1 + 0.3, 1.3 + 0.4), 0.5, 1e-9);
    EXPECT_NEAR(vehicle.obstacles()[1].distance_m(-1, 0), 0.6, 1e-9);
  }
}

TEST(Layout, PlacedAndFixedObstaclesKeepApart) {
  const World world(kArena + R"(<numeric name="passage" data="0.8"/>)",
                    kFloor + R"(<body name="obstacle_a" pos="0 0 0.2">
                                  <geom type="cylinder" size="0.4 0.2"/></body>
                                <body name="obstacle_b" mocap="true" pos="0 0 0.2">
                                  <geom type="box" size="0.2 0.2 0.2"/></body>)");
  const double circle = std::hypot(0.2, 0.2);
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    const Obstacle placed = world.vehicle(seed).obstacles()[1];
    EXPECT_LE(std::max(std::abs(placed.x_m), std::abs(placed.y_m)), 3 - 0.8 - circle);
    EXPECT_GE(std::hypot(placed.x_m, placed.y_m), 0.4 + 0.8 + circle);
  }
}

TEST(Coverage, CountsCellsOfHalfAMetre) {
  const World world(kArena + R"(<numeric name="start" data="-2.75 0.25 0"/>)", kFloor);
  Vehicle vehicle = world.vehicle();
  EXPECT_EQ(vehicle.statistics().free_cells, 144U);  // 12 x 12, border centres 0.25 m from a wall
  EXPECT_EQ(vehicle.statistics().visited_cells, 1U);
  vehicle.command(0.5, 0);
  vehicle.step(5 * kSecond);  // to x = -0.3: cells -3.0, -2.5, ... -0.5
  EXPECT_EQ(vehicle.statistics().visited_cells, 6U);
  EXPECT_NEAR(vehicle.statistics().coverage, 6.0 / 144, 1e-12);
  vehicle.command(-0.5, 0);
  vehicle.step(2 * kSecond);
  EXPECT_EQ(vehicle.statistics().visited_cells, 6U);  // known ground
}

TEST(Coverage, CellsUnderObstaclesAreNotFree) {
  // A box over the four cells around the origin, plus the vehicle's radius of 0.234 m: it keeps
  // the centres at 0.25 m within, those at 0.75 m (0.35 m from its face) without.
  const World world(kArena + R"(<numeric name="start" data="-2 0 0"/>)",
                    kFloor + R"(<body name="obstacle_a" pos="0 0 0.2">
                                  <geom type="box" size="0.4 0.4 0.2"/></body>)");
  EXPECT_EQ(world.vehicle().statistics().free_cells, 140U);
}

TEST(Collisions, DrivingIntoAWallIsOne) {
  const World world(kArena + R"(<numeric name="start" data="2 0 0"/>)", kFloor + kWalls);
  Vehicle vehicle = world.vehicle();
  vehicle.command(0.5, 0);
  vehicle.step(kSecond);
  EXPECT_EQ(vehicle.statistics().collisions, 0U);
  vehicle.step(5 * kSecond);  // pushes for seconds: still one
  EXPECT_EQ(vehicle.statistics().collisions, 1U);
  EXPECT_LT(vehicle.pose().x_m, 2.81);
  vehicle.command(-0.5, 0);
  vehicle.step(2 * kSecond);
  vehicle.command(0.5, 0);
  vehicle.step(3 * kSecond);
  EXPECT_EQ(vehicle.statistics().collisions, 2U);
}

TEST(Collisions, EveryThingCountsForItself) {
  // Into a corner: two walls.
  const World world(kArena + R"(<numeric name="start" data="2 2 0.785398"/>)", kFloor + kWalls);
  Vehicle vehicle = world.vehicle();
  vehicle.command(0.5, 0);
  vehicle.step(4 * kSecond);
  EXPECT_EQ(vehicle.statistics().collisions, 2U);
}

TEST(Collisions, ObstaclesPlacedByTheSeedAreSolid) {
  const World world(kArena + R"(<numeric name="passage" data="0.5"/>
                                <numeric name="start_clearance" data="0.3"/>)",
                    kFloor + kWalls + R"(<body name="obstacle_a" mocap="true" pos="0 0 0.2">
                                  <geom type="cylinder" size="1.5 0.2"/></body>)");
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    Vehicle vehicle = world.vehicle(seed);
    const Obstacle& tower = vehicle.obstacles()[0];
    // Turn towards it, then drive.
    const Pose start = vehicle.pose();
    const double bearing =
        turned(start.theta_rad, std::atan2(tower.y_m - start.y_m, tower.x_m - start.x_m));
    for (int i = 0; i < 1000; ++i) {
      const Pose pose = vehicle.pose();
      const double wanted =
          turned(pose.theta_rad, std::atan2(tower.y_m - pose.y_m, tower.x_m - pose.x_m));
      vehicle.command(std::abs(wanted) < 0.2 ? 0.4 : 0, 2 * wanted);
      vehicle.step(10 * kMs);
    }
    EXPECT_GE(vehicle.statistics().collisions, 1U) << "seed " << seed << " bearing " << bearing;
    EXPECT_GT(tower.distance_m(vehicle.pose().x_m, vehicle.pose().y_m), 0.1);
  }
}

TEST(FindWorld, TheShippedOnesAreFoundByName) {
  const std::string arena = find_world("arena.xml");
  EXPECT_TRUE(std::filesystem::exists(arena));
  EXPECT_TRUE(arena.ends_with("share/spikeloop/worlds/arena.xml"));
  EXPECT_EQ(find_world(arena), arena);
  EXPECT_EQ(Vehicle({"arena.xml", 1}).world(), arena);
}

}  // namespace
}  // namespace spikeloop::vehicle
