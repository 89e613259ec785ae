// Inertial unit, wheels, photodiodes and where things sit, against mechanics and optics.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <cmath>
#include <numbers>

#include "spikeloop/core/error.hpp"
#include "worlds.hpp"

namespace spikeloop::vehicle {
namespace {

constexpr double kGravity = 9.81;

class Sensors : public testing::Test {
 protected:
  World plain_{kArena + kStart, kFloor};
};

TEST_F(Sensors, AtRestTheInertialUnitFeelsTheFloor) {
  const World turned_start(kArena + R"(<numeric name="start" data="0.5 0.3 2.1"/>)", kFloor);
  Vehicle vehicle = turned_start.vehicle();
  for (const TimeNs wait : {TimeNs{0}, 2 * kSecond}) {
    if (wait > 0) vehicle.step(wait);
    const Imu imu = vehicle.imu();
    EXPECT_EQ(imu.stamp, wait);
    EXPECT_NEAR(imu.linear_acceleration_m_s2[0], 0, 1e-3);
    EXPECT_NEAR(imu.linear_acceleration_m_s2[1], 0, 1e-3);
    EXPECT_NEAR(imu.linear_acceleration_m_s2[2], kGravity, 1e-3);
    for (const double rate : imu.angular_velocity_rad_s) EXPECT_NEAR(rate, 0, 1e-3);
    EXPECT_NEAR(imu.orientation[0], std::cos(2.1 / 2), 1e-4);
    EXPECT_NEAR(imu.orientation[3], std::sin(2.1 / 2), 1e-4);
  }
}

TEST_F(Sensors, AccelerationAddsUpToTheVelocity) {
  Vehicle vehicle = plain_.vehicle();
  vehicle.command(0.8, 0);
  double speed = 0;
  double most = 0;
  for (int i = 0; i < 100; ++i) {
    vehicle.step(10 * kMs);
    const double acceleration = vehicle.imu().linear_acceleration_m_s2[0];
    most = std::max(most, acceleration);
    speed += 0.01 * acceleration;
  }
  // The frame's pitch, a fraction of a degree, lets gravity in.
  EXPECT_NEAR(speed, vehicle.odometry().linear_x_m_s, 0.02);
  EXPECT_NEAR(most, 4.0, 1.0) << "the wheels gain 4 m/s^2";
}

TEST_F(Sensors, InACircleItFeelsSpeedTimesYawRate) {
  for (const double rate : {0.8, -0.5}) {
    Vehicle vehicle = plain_.vehicle();
    vehicle.command(0.4, rate);
    vehicle.step(kSecond);
    double sideways = 0;
    double turning = 0;
    double expected = 0;
    constexpr int kReadings = 400;
    for (int i = 0; i < kReadings; ++i) {
      vehicle.step(10 * kMs);
      const Imu imu = vehicle.imu();
      const Odometry odometry = vehicle.odometry();
      sideways += imu.linear_acceleration_m_s2[1] / kReadings;
      turning += imu.angular_velocity_rad_s[2] / kReadings;
      expected += odometry.linear_x_m_s * odometry.angular_z_rad_s / kReadings;
    }
    EXPECT_NEAR(sideways, expected, 0.03 * std::abs(expected));
    EXPECT_NEAR(sideways, 0.4 * rate, 0.15 * std::abs(0.4 * rate));
    EXPECT_NEAR(turning, rate, 0.1 * std::abs(rate));
  }
}

TEST_F(Sensors, WheelsTurnAsFastAsTheirRimsRoll) {
  constexpr double kRadius = 0.08;
  Vehicle vehicle = plain_.vehicle();
  const double half_track = vehicle.half_effective_track_m();
  for (const auto& [speed, rate] : {std::pair{0.4, 0.0}, {-0.2, 0.0}, {0.0, 1.0}, {0.3, -0.5}}) {
    vehicle.command(speed, rate);
    vehicle.step(kSecond);
    const JointStates before = vehicle.joint_states();
    EXPECT_EQ(before.names, (std::vector<std::string>{"wheel_front_left", "wheel_front_right",
                                                      "wheel_rear_left", "wheel_rear_right"}));
    vehicle.step(kSecond);
    const JointStates after = vehicle.joint_states();
    EXPECT_EQ(after.stamp - before.stamp, kSecond);
    for (std::size_t i = 0; i < 4; ++i) {
      const double rim = speed + (i % 2 == 0 ? -1 : 1) * rate * half_track;
      const double turned = after.positions[i] - before.positions[i];
      EXPECT_NEAR(turned, rim / kRadius, 0.03 * std::abs(rim / kRadius) + 1e-3);
      EXPECT_NEAR(after.velocities[i], rim / kRadius, 0.03 * std::abs(rim / kRadius) + 1e-3);
    }
  }
}

TEST_F(Sensors, MotorsOfAWheelThatIsHeldPush) {
  Vehicle vehicle = plain_.vehicle();
  vehicle.command(0, 1.0);  // wheels that skid have to be driven
  vehicle.step(kSecond);
  const JointStates states = vehicle.joint_states();
  ASSERT_EQ(states.efforts.size(), 4U);
  EXPECT_LT(states.efforts[0], -0.01);
  EXPECT_GT(states.efforts[1], 0.01);
}

TEST_F(Sensors, MountsAreThoseOfTheFile) {
  const Vehicle vehicle = plain_.vehicle();
  const Mount laser = vehicle.laser_mount();
  EXPECT_EQ(laser.position_m, (Vector3{0.10, 0, 0.12}));
  EXPECT_EQ(laser.orientation, (Quaternion{1, 0, 0, 0}));

  const auto camera = vehicle.camera_mount();
  ASSERT_TRUE(camera);
  const auto seen = [&](Vector3 axis) {
    Vector3 out{};
    mju_rotVecQuat(out.data(), axis.data(), camera->orientation.data());
    return out;
  };
  using testing::DoubleNear;
  using testing::ElementsAre;
  const auto is = [](double x, double y, double z) {
    return ElementsAre(DoubleNear(x, 1e-9), DoubleNear(y, 1e-9), DoubleNear(z, 1e-9));
  };
  EXPECT_THAT(seen({0, 0, 1}), is(1, 0, 0)) << "into the picture is ahead";
  EXPECT_THAT(seen({1, 0, 0}), is(0, -1, 0)) << "to the picture's right is to the right";
  EXPECT_THAT(seen({0, 1, 0}), is(0, 0, -1)) << "down in the picture is down";
}

std::string lamp(const std::string& name, const std::string& at) {
  return "<body name=\"" + name + "_body\" pos=\"" + at + "\"><geom type=\"cylinder\" size=\"" +
         "0.05 0.2\"/><site name=\"" + name + "\"/></body>";
}

/// Of a lamp of 1 cd at (x, y), as high as the diodes, seen by one of a vehicle at the origin.
double lux(double x, double y, double side) {
  const double dx = x - 0.18;
  const double dy = y - side * 0.08;
  const double cosine = (dx + side * dy) * std::numbers::sqrt2 / 2 / std::hypot(dx, dy);
  return cosine > 0 ? cosine / (dx * dx + dy * dy) : 0;
}

TEST(Photodiodes, FollowLambertAndTheInverseSquare) {
  for (const auto& [x, y] :
       {std::pair{2.0, 0.0}, {1.0, 1.5}, {1.0, -1.5}, {-1.0, 2.0}, {-1.0, 0.1}}) {
    const World world(kArena + kStart + R"(<numeric name="lamp_1" data="2.5"/>)",
                      kFloor + lamp("lamp_1", fmt::format("{} {} 0.17", x, y)));
    const auto light = world.vehicle().light();
    ASSERT_TRUE(light);
    EXPECT_NEAR(light->left_lux, 2.5 * lux(x, y, 1), 1e-9) << x << " " << y;
    EXPECT_NEAR(light->right_lux, 2.5 * lux(x, y, -1), 1e-9) << x << " " << y;
  }
}

TEST(Photodiodes, LampsAddUpAndThingsThrowShadows) {
  const std::string numerics =
      kArena + kStart + R"(<numeric name="lamp_1" data="1"/><numeric name="lamp_2" data="3"/>)";
  const std::string lamps = lamp("lamp_1", "2 1 0.17") + lamp("lamp_2", "2 -1 0.17");
  const World open(numerics, kFloor + lamps);
  const double both = lux(2, 1, 1) + 3 * lux(2, -1, 1);
  EXPECT_NEAR(open.vehicle().light()->left_lux, both, 1e-9);

  // Half way between the first lamp and the diodes; it stands beside the way from the second.
  const World shaded(
      numerics, kFloor + lamps + R"(<geom type="box" size="0.1 0.2 0.3" pos="1.1 0.55 0.3"/>)");
  EXPECT_NEAR(shaded.vehicle().light()->left_lux, 3 * lux(2, -1, 1), 1e-9);
}

TEST(Photodiodes, TurnWithTheVehicle) {
  const World world(kArena + kStart + R"(<numeric name="lamp_1" data="1"/>)",
                    kFloor + lamp("lamp_1", "2 0 0.17"));
  Vehicle vehicle = world.vehicle();
  EXPECT_NEAR(vehicle.light()->left_lux, vehicle.light()->right_lux, 1e-12);
  vehicle.command(0, 0.5);
  vehicle.step(kSecond);
  EXPECT_GT(vehicle.light()->right_lux, 1.5 * vehicle.light()->left_lux)
      << "it has turned to the left, so the lamp is on its right";
}

TEST(Photodiodes, MeasureNothingInAWorldWithoutLamps) {
  EXPECT_FALSE(World(kArena + kStart, kFloor).vehicle().light());
}

TEST(Cue, StandsWhereTheSeedHasDrawn) {
  const std::string numerics = kArena + kStart +
                               R"(<numeric name="cue_place_1" data="-1 2 0"/>
                                  <numeric name="cue_place_2" data="1 2 1.5"/>)";
  const World world(
      numerics,
      kFloor + R"(<body name="cue" mocap="true" pos="0 0 0.3"><geom size="0.1"/></body>)");
  int at_first = 0;
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    const Vehicle vehicle = world.vehicle(seed);
    const int place = vehicle.cue_place();
    EXPECT_EQ(place, world.vehicle(seed).cue_place());
    ASSERT_TRUE(place == 1 || place == 2);
    at_first += place == 1;
    EXPECT_EQ(vehicle.data().mocap_pos[0], place == 1 ? -1 : 1);
    EXPECT_EQ(vehicle.data().mocap_pos[2], 0.3);
  }
  EXPECT_GT(at_first, 10);
  EXPECT_LT(at_first, 30);
  EXPECT_EQ(World(kArena + kStart, kFloor).vehicle().cue_place(), 0);
}

TEST(ShippedWorlds, HaveShortNames) {
  for (const char* name : {"arena", "phototaxis", "t_maze", "lane"}) {
    const Vehicle vehicle({name, 2});
    EXPECT_THAT(vehicle.world(), testing::EndsWith(std::string("worlds/") + name + ".xml"));
    EXPECT_TRUE(vehicle.camera_mount());
  }
}

TEST(ShippedWorlds, ThePhototaxisWorldHasALampInSight) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    Vehicle vehicle({"phototaxis", seed});
    ASSERT_TRUE(vehicle.light());
    // Turned once around it sees it, unless it starts in a shadow.
    double brightest = 0;
    vehicle.command(0, 2);
    for (int i = 0; i < 40; ++i) {
      vehicle.step(100 * kMs);
      brightest = std::max(brightest, vehicle.light()->left_lux + vehicle.light()->right_lux);
    }
    EXPECT_GT(brightest, 1.0 / (36 + 36)) << seed;
  }
}

TEST(ShippedWorlds, TheCueOfTheMazeIsOnItsSideAndOutOfSightAtTheJunction) {
  bool seen[3] = {};
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    Vehicle vehicle({"t_maze", seed});
    const int place = vehicle.cue_place();
    ASSERT_TRUE(place == 1 || place == 2);
    seen[place] = true;
    vehicle.command(0.5, 0);
    vehicle.step(kSecond);
    const Light beside = *vehicle.light();
    const double difference = beside.left_lux - beside.right_lux;
    EXPECT_GT(place == 1 ? difference : -difference, 0.05);
    vehicle.step(3 * kSecond);
    EXPECT_GT(vehicle.pose().y_m, -0.3);
    EXPECT_EQ(vehicle.light()->left_lux + vehicle.light()->right_lux, 0);
    EXPECT_EQ(vehicle.statistics().collisions, 0U);
  }
  EXPECT_TRUE(seen[1] && seen[2]);
}

}  // namespace
}  // namespace spikeloop::vehicle
