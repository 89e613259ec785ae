// Driving: commanded and real speeds, limits, determinism.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <tuple>

#include "spikeloop/core/error.hpp"
#include "worlds.hpp"

namespace spikeloop::vehicle::drive_test {
namespace {

class Drive : public testing::Test {
 protected:
  World plain_{kArena + kStart, kFloor};
};

TEST_F(Drive, CommandedSpeedIsDriven) {
  for (const double speed : {0.2, 0.5, 1.0, -0.5}) {
    Vehicle vehicle = plain_.vehicle();
    vehicle.command(speed, 0);
    vehicle.step(kSecond);
    const Pose before = vehicle.pose();
    vehicle.step(kSecond);
    const Pose after = vehicle.pose();
    EXPECT_NEAR(after.x_m - before.x_m, speed, 0.02 * std::abs(speed)) << speed;
    EXPECT_NEAR(after.y_m, 0, 1e-3) << speed;
    EXPECT_NEAR(vehicle.odometry().linear_x_m_s, speed, 0.02 * std::abs(speed));
  }
}

TEST_F(Drive, CommandedYawRateIsTurned) {
  for (const double rate : {0.1, 0.5, -1.0, 2.0, -3.0}) {
    for (const double speed : {0.0, 0.3}) {
      Vehicle vehicle = plain_.vehicle();
      vehicle.command(speed, rate);
      vehicle.step(kSecond);
      const double before = vehicle.pose().theta_rad;
      vehicle.step(kSecond / 2);
      const double measured = turned(before, vehicle.pose().theta_rad) / 0.5;
      EXPECT_NEAR(measured, rate, 0.1 * std::abs(rate)) << rate << " at " << speed;
      EXPECT_NEAR(vehicle.odometry().angular_z_rad_s, rate, 0.1 * std::abs(rate));
    }
  }
}

/// Readings are of the body's parts where the vehicle has come to, whether or not anything else
/// looks.
TEST(Looking, ChangesNothing) {
  for (const std::uint64_t seed : {1, 2, 3}) {
    Vehicle looked_at({.world = "arena.xml", .seed = seed});
    Vehicle left_alone({.world = "arena.xml", .seed = seed});
    for (int i = 0; i < 300; ++i) {
      const LaserScan scan = looked_at.scan();
      looked_at.scan();
      looked_at.light();
      looked_at.imu();
      if (i % 50 == 0) {
        ASSERT_EQ(scan.ranges_m, left_alone.scan().ranges_m) << "seed " << seed << ", " << i;
      }
      for (Vehicle* vehicle : {&looked_at, &left_alone}) {
        vehicle->command(0.5, i < 100 ? 0.2 : -1.0);
        vehicle->step(2 * kMs);
      }
      ASSERT_EQ(looked_at.pose().x_m, left_alone.pose().x_m) << "seed " << seed << ", " << i;
      ASSERT_EQ(looked_at.pose().theta_rad, left_alone.pose().theta_rad) << "seed " << seed;
    }
  }
}

TEST_F(Drive, ACircleHasTheRadiusOfSpeedOverYawRate) {
  Vehicle vehicle = plain_.vehicle();
  vehicle.command(0.4, 0.8);
  vehicle.step(kSecond);
  // Three points of a circle: a quarter turn apart and half a turn apart (whatever the exact rate).
  double width = 0;
  const Pose first = vehicle.pose();
  for (int i = 0; i < 1000; ++i) {
    vehicle.step(10 * kMs);
    const Pose now = vehicle.pose();
    width = std::max(width, std::hypot(now.x_m - first.x_m, now.y_m - first.y_m));
  }
  EXPECT_NEAR(width / 2, 0.4 / 0.8, 0.05);
}

TEST_F(Drive, TheEffectiveTrackIsThatOfTheMomentBalance) {
  // Wheels at (+-0.10, +-0.13): sum(x^2 + y^2) / sum(|y|).
  EXPECT_NEAR(plain_.vehicle().half_effective_track_m(), (0.01 + 0.0169) / 0.13, 1e-12);
  // The corner of the 0.40 m x 0.21 m body is farther out than a wheel's: hypot(0.18, 0.15).
  EXPECT_NEAR(plain_.vehicle().radius_m(), std::hypot(0.18, 0.15), 1e-12);
}

TEST_F(Drive, OdometryIsTheDerivativeOfThePose) {
  Vehicle vehicle = plain_.vehicle();
  vehicle.command(0.4, 0.7);
  vehicle.step(2 * kSecond);
  const Odometry odometry = vehicle.odometry();
  EXPECT_EQ(odometry.stamp, 2 * kSecond);
  vehicle.step(20 * kMs);
  const Pose after = vehicle.pose();
  const double dx = (after.x_m - odometry.pose.x_m) / 0.02;
  const double dy = (after.y_m - odometry.pose.y_m) / 0.02;
  const double middle = odometry.pose.theta_rad + 0.01 * odometry.angular_z_rad_s;
  EXPECT_NEAR(std::cos(middle) * dx + std::sin(middle) * dy, odometry.linear_x_m_s, 2e-3);
  EXPECT_NEAR(-std::sin(middle) * dx + std::cos(middle) * dy, odometry.linear_y_m_s, 2e-3);
  EXPECT_NEAR(turned(odometry.pose.theta_rad, after.theta_rad) / 0.02, odometry.angular_z_rad_s,
              2e-3);
}

TEST_F(Drive, WithoutACommandItStandsStill) {
  Vehicle vehicle = plain_.vehicle();
  vehicle.step(2 * kSecond);
  EXPECT_NEAR(vehicle.pose().x_m, 0, 1e-4);
  EXPECT_NEAR(vehicle.pose().y_m, 0, 1e-4);
  EXPECT_NEAR(vehicle.statistics().distance_m, 0, 1e-3);
}

TEST_F(Drive, DistanceAndMeanSpeedAddUp) {
  Vehicle vehicle = plain_.vehicle();
  EXPECT_EQ(vehicle.statistics().mean_speed_m_s, 0);
  double path = 0;
  for (const double speed : {0.5, -0.5}) {
    vehicle.command(speed, 0.2);
    for (int i = 0; i < 1000; ++i) {
      const Pose before = vehicle.pose();
      vehicle.step(2 * kMs);
      path += std::hypot(vehicle.pose().x_m - before.x_m, vehicle.pose().y_m - before.y_m);
    }
  }
  const Statistics statistics = vehicle.statistics();
  EXPECT_NEAR(statistics.distance_m, path, 1e-9);
  EXPECT_NEAR(statistics.distance_m, 2.0, 0.2);
  EXPECT_NEAR(statistics.mean_speed_m_s, statistics.distance_m / 4, 1e-12);
}

TEST_F(Drive, CommandsAreClampedAndCounted) {
  Vehicle vehicle = plain_.vehicle();
  vehicle.command(1.0, -3.0);
  EXPECT_EQ(vehicle.statistics().clamped_commands, 0U);
  vehicle.command(7, 0);
  EXPECT_EQ(vehicle.statistics().clamped_commands, 1U);
  vehicle.step(kSecond);
  EXPECT_NEAR(vehicle.odometry().linear_x_m_s, 1.0, 0.02);
}

TEST_F(Drive, ACommandThatIsNotFiniteStops) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double inf = std::numeric_limits<double>::infinity();
  for (const auto& [linear, angular] :
       {std::tuple{nan, 0.0}, std::tuple{0.5, nan}, std::tuple{inf, 0.0}, std::tuple{0.5, -inf}}) {
    Vehicle vehicle = plain_.vehicle();
    vehicle.command(0.5, 0.5);
    vehicle.step(kSecond);
    vehicle.command(linear, angular);
    vehicle.step(kSecond);
    EXPECT_NEAR(vehicle.odometry().linear_x_m_s, 0, 1e-3);
    EXPECT_NEAR(vehicle.odometry().angular_z_rad_s, 0, 1e-3);
    EXPECT_EQ(vehicle.statistics().invalid_commands, 1U);
  }
}

// A course that also bumps into things.
std::vector<double> course(std::uint64_t seed, TimeNs piece) {
  Vehicle vehicle({"arena.xml", seed});
  std::vector<double> trace;
  const double commands[][2] = {{0.5, 0.3}, {0.8, -1.0}, {-0.4, 0.5}, {1.0, 0.0}};
  for (const auto& [linear, angular] : commands) {
    vehicle.command(linear, angular);
    for (TimeNs t = 0; t < 2 * kSecond; t += piece) vehicle.step(piece);
    const Odometry odometry = vehicle.odometry();
    trace.insert(trace.end(), {odometry.pose.x_m, odometry.pose.y_m, odometry.pose.theta_rad,
                               odometry.linear_x_m_s, odometry.angular_z_rad_s});
    for (const float range : vehicle.scan().ranges_m) trace.push_back(range);
  }
  trace.push_back(static_cast<double>(vehicle.statistics().collisions));
  return trace;
}

TEST(Determinism, SameSeedAndCommandsGiveTheSameBits) {
  EXPECT_EQ(course(3, 10 * kMs), course(3, 10 * kMs));
}

TEST(Determinism, TheTrajectoryDoesNotDependOnTheStep) {
  const auto reference = course(5, 10 * kMs);
  EXPECT_EQ(course(5, 1 * kMs), reference);
  EXPECT_EQ(course(5, 2 * kSecond), reference);
}

TEST(Determinism, OtherSeedsGiveOtherWorlds) {
  EXPECT_NE(course(3, 100 * kMs), course(4, 100 * kMs));
}

TEST_F(Drive, ATimeThatIsNotPositiveIsRefused) {
  Vehicle vehicle = plain_.vehicle();
  try {
    vehicle.step(0);
    FAIL();
  } catch (const ConfigurationError& error) {
    EXPECT_STREQ(error.what(), "cannot advance the robot by 0 s; write a time above 0 [SL0801]");
  }
}

}  // namespace
}  // namespace spikeloop::vehicle::drive_test
