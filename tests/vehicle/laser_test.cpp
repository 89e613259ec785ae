// The laser against ray geometry worked out here, without MuJoCo.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <optional>

#include "worlds.hpp"

namespace spikeloop::vehicle {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kLaserAhead = 0.10;  // of the vehicle's centre, m

struct Ray {
  double x, y, dx, dy;
};

// Nearest root of |origin + t * direction - centre| = radius.
double to_circle(const Ray& ray, const Obstacle& o) {
  const double px = ray.x - o.x_m;
  const double py = ray.y - o.y_m;
  const double b = px * ray.dx + py * ray.dy;
  const double root = b * b - (px * px + py * py - o.radius_m * o.radius_m);
  if (root < 0) return kInfinity;
  const double t = -b - std::sqrt(root);
  return t > 0 ? t : kInfinity;
}

// A segment from (ax, ay) to (bx, by), by Cramer's rule.
double to_segment(const Ray& ray, double ax, double ay, double bx, double by) {
  const double ex = bx - ax;
  const double ey = by - ay;
  const double determinant = ex * ray.dy - ey * ray.dx;
  if (std::abs(determinant) < 1e-12) return kInfinity;
  const double wx = ax - ray.x;
  const double wy = ay - ray.y;
  const double t = (ex * wy - ey * wx) / determinant;
  const double u = (ray.dx * wy - ray.dy * wx) / determinant;
  return t > 0 && u >= 0 && u <= 1 ? t : kInfinity;
}

double to_box(const Ray& ray, const Obstacle& o) {
  const double c = std::cos(o.theta_rad);
  const double s = std::sin(o.theta_rad);
  const double signs[4][2] = {{1, 1}, {-1, 1}, {-1, -1}, {1, -1}};
  double nearest = kInfinity;
  for (int i = 0; i < 4; ++i) {
    double corner[2][2];
    for (int end = 0; end < 2; ++end) {
      const double lx = signs[(i + end) % 4][0] * o.half_x_m;
      const double ly = signs[(i + end) % 4][1] * o.half_y_m;
      corner[end][0] = o.x_m + c * lx - s * ly;
      corner[end][1] = o.y_m + s * lx + c * ly;
    }
    nearest =
        std::min(nearest, to_segment(ray, corner[0][0], corner[0][1], corner[1][0], corner[1][1]));
  }
  return nearest;
}

double expected_range(const Ray& ray, const Arena& a, const std::vector<Obstacle>& obstacles) {
  double nearest = std::min({to_segment(ray, a.min_x_m, a.min_y_m, a.max_x_m, a.min_y_m),
                             to_segment(ray, a.max_x_m, a.min_y_m, a.max_x_m, a.max_y_m),
                             to_segment(ray, a.max_x_m, a.max_y_m, a.min_x_m, a.max_y_m),
                             to_segment(ray, a.min_x_m, a.max_y_m, a.min_x_m, a.min_y_m)});
  for (const auto& obstacle : obstacles) {
    nearest = std::min(nearest, obstacle.shape == Obstacle::Shape::box ? to_box(ray, obstacle)
                                                                       : to_circle(ray, obstacle));
  }
  return nearest;
}

Ray beam(const Pose& pose, const LaserScan& scan, std::size_t i) {
  const double angle = pose.theta_rad + static_cast<double>(scan.angle_min_rad) +
                       static_cast<double>(i) * static_cast<double>(scan.angle_increment_rad);
  return {pose.x_m + kLaserAhead * std::cos(pose.theta_rad),
          pose.y_m + kLaserAhead * std::sin(pose.theta_rad), std::cos(angle), std::sin(angle)};
}

TEST(Laser, HasTheFieldsOfTheIssue) {
  Vehicle vehicle({"arena.xml", 1});
  vehicle.step(123 * kMs);
  const LaserScan scan = vehicle.scan();
  EXPECT_EQ(scan.stamp, 123 * kMs);
  EXPECT_EQ(scan.ranges_m.size(), 100U);
  EXPECT_FLOAT_EQ(scan.angle_min_rad, static_cast<float>(-std::numbers::pi / 2));
  EXPECT_FLOAT_EQ(scan.angle_max_rad, static_cast<float>(std::numbers::pi / 2));
  EXPECT_FLOAT_EQ(scan.angle_increment_rad, static_cast<float>(std::numbers::pi / 99));
  EXPECT_FLOAT_EQ(scan.scan_time_s, 0.05F);
  EXPECT_FLOAT_EQ(scan.range_min_m, 0.05F);
  EXPECT_FLOAT_EQ(scan.range_max_m, 5.0F);
}

TEST(Laser, DistancesAgreeWithRayGeometry) {
  int compared = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    Vehicle vehicle({"arena.xml", seed});
    vehicle.step(500 * kMs);  // comes to rest
    const LaserScan scan = vehicle.scan();
    for (std::size_t i = 0; i < scan.ranges_m.size(); ++i) {
      const Ray ray = beam(vehicle.pose(), scan, i);
      const double expected = expected_range(ray, vehicle.arena(), vehicle.obstacles());
      const auto measured = static_cast<double>(scan.ranges_m[i]);
      // A beam that grazes an edge may fall on either side of it.
      const Ray left{ray.x, ray.y, ray.dx - 1e-3 * ray.dy, ray.dy + 1e-3 * ray.dx};
      const Ray right{ray.x, ray.y, ray.dx + 1e-3 * ray.dy, ray.dy - 1e-3 * ray.dx};
      const double a = expected_range(left, vehicle.arena(), vehicle.obstacles());
      const double b = expected_range(right, vehicle.arena(), vehicle.obstacles());
      if (std::abs(a - b) > 0.1 || std::abs(expected - 5.0) < 0.01) continue;
      ++compared;
      if (expected > 5.0) {
        EXPECT_EQ(measured, kInfinity) << "seed " << seed << " beam " << i;
      } else {
        EXPECT_NEAR(measured, expected, 2e-3 * (1 + expected)) << "seed " << seed << " beam " << i;
      }
    }
  }
  EXPECT_GT(compared, 1500);
}

TEST(Laser, TheFirstBeamLooksRightAndTheLastOneLeft) {
  const World world(kArena + R"(<numeric name="start" data="0 1 0"/>)", kFloor + kWalls);
  Vehicle vehicle = world.vehicle();
  const LaserScan scan = vehicle.scan();
  EXPECT_NEAR(scan.ranges_m.front(), 4, 0.01);  // y = 1, looking east: right is the south wall
  EXPECT_NEAR(scan.ranges_m.back(), 2, 0.01);
}

TEST(Laser, NothingInRangeIsPlusInfinity) {
  const World world(kArena + kStart, kFloor);
  for (const float range : world.vehicle().scan().ranges_m) {
    EXPECT_EQ(range, std::numeric_limits<float>::infinity());
  }
}

// A thin rod just before the mast: 0.03 m before the laser, above the body.
TEST(Laser, TooNearIsMinusInfinity) {
  const World world(kArena + kStart,
                    kFloor + R"(<geom name="rod" type="box" size="0.001 0.3 0.02" pos="0.13 0 0.2"
                                contype="0" conaffinity="0"/>)");
  const LaserScan scan = world.vehicle().scan();
  EXPECT_EQ(scan.ranges_m[49], -std::numeric_limits<float>::infinity());
  EXPECT_EQ(scan.ranges_m[50], -std::numeric_limits<float>::infinity());
}

TEST(Laser, LooksWhereTheVehicleIsNow) {
  const World world(kArena + kStart, kFloor + kWalls);
  Vehicle vehicle = world.vehicle();
  vehicle.command(0.5, 0);
  for (int i = 0; i < 30; ++i) {
    vehicle.step(100 * kMs);
    const Ray ray = beam(vehicle.pose(), vehicle.scan(), 49);
    const double expected = expected_range(ray, vehicle.arena(), {});
    EXPECT_NEAR(static_cast<double>(vehicle.scan().ranges_m[49]), expected, 0.02);
  }
}

}  // namespace
}  // namespace spikeloop::vehicle
