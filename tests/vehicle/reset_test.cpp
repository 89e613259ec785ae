// A vehicle that begins anew is one that was just made.
#include <gtest/gtest.h>

#include "spikeloop/vehicle/vehicle.hpp"

namespace spikeloop::vehicle::reset_test {
namespace {

constexpr TimeNs kMs = 1'000'000;

void expect_same(const Vehicle& one, const Vehicle& other, int step) {
  ASSERT_EQ(one.scan().ranges_m, other.scan().ranges_m) << step;
  ASSERT_EQ(one.pose().x_m, other.pose().x_m) << step;
  ASSERT_EQ(one.pose().y_m, other.pose().y_m) << step;
  ASSERT_EQ(one.pose().theta_rad, other.pose().theta_rad) << step;
  ASSERT_EQ(one.imu().linear_acceleration_m_s2, other.imu().linear_acceleration_m_s2) << step;
  ASSERT_EQ(one.joint_states().velocities, other.joint_states().velocities) << step;
  ASSERT_EQ(one.light().has_value(), other.light().has_value());
  if (one.light()) {
    ASSERT_EQ(one.light()->left_lux, other.light()->left_lux) << step;
  }
}

/// After a drive into a wall, in the middle of a physics step.
TEST(Reset, LeavesNoTraceOfWhatWasBefore) {
  for (const char* const world : {"arena", "phototaxis", "t_maze", "lane"}) {
    Vehicle used({world, 1});
    used.command(1, 0.2);
    used.step(4001 * kMs);
    used.reset(5);
    Vehicle fresh({world, 5});
    EXPECT_EQ(used.time(), 4001 * kMs);
    EXPECT_EQ(used.cue_place(), fresh.cue_place());
    for (int i = 0; i < 100; ++i) {
      expect_same(used, fresh, i);
      used.command(0.5, 0.01 * i);
      fresh.command(0.5, 0.01 * i);
      used.step(10 * kMs);
      fresh.step(10 * kMs);
    }
  }
}

TEST(Reset, StatisticsGoOn) {
  Vehicle vehicle({"arena", 1});
  vehicle.command(1, 0);
  vehicle.step(8000 * kMs);
  const Statistics before = vehicle.statistics();
  ASSERT_GT(before.collisions, 0U);
  vehicle.reset(1);
  EXPECT_EQ(vehicle.statistics().collisions, before.collisions);
  EXPECT_EQ(vehicle.statistics().distance_m, before.distance_m);
  vehicle.command(1, 0);
  vehicle.step(8000 * kMs);
  EXPECT_EQ(vehicle.statistics().collisions, 2 * before.collisions);
  EXPECT_DOUBLE_EQ(vehicle.statistics().distance_m, 2 * before.distance_m);
  EXPECT_DOUBLE_EQ(vehicle.statistics().mean_speed_m_s, before.mean_speed_m_s);
}

}  // namespace
}  // namespace spikeloop::vehicle::reset_test
