// What the vehicle's camera sees, against projection worked out here.
#include "spikeloop/pictures/camera.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <iterator>
#include <numbers>
#include <thread>

#include "spikeloop/core/error.hpp"
#include "worlds.hpp"

namespace spikeloop::pictures {
namespace {

constexpr double kCameraAhead = 0.195;  // of the vehicle's centre, m
constexpr double kCameraHeight = 0.145;

std::string box(const std::string& position, const std::string& size, const std::string& colour) {
  return "<geom type=\"box\" pos=\"" + position + "\" size=\"" + size + "\" rgba=\"" + colour +
         " 1\"/>";
}

TEST(Camera, AWallOfOneColourFillsThePicture) {
  const World world(box("1 0 1", "0.1 3 1", "0.9 0.1 0.1"));
  const vehicle::Vehicle vehicle = world.vehicle();
  // The wall's foot, 0.7 m away and 0.145 m below, is below the lower edge of a flat picture.
  const CameraOptions options{.size = {64, 8}, .field_of_view_deg = 80};
  Camera camera(vehicle, options);
  const Image& image = camera.look(vehicle);
  ASSERT_EQ(image.size, (Size{64, 8}));
  ASSERT_EQ(image.rgb.size(), 3U * 64 * 8);
  for (std::uint32_t row = 0; row < 8; ++row) {
    for (std::uint32_t column = 0; column < 64; ++column) {
      const Colour pixel = at(image, column, row);
      EXPECT_NEAR(pixel[0], 0.9 * 255, 3);
      EXPECT_NEAR(pixel[1], 0.1 * 255, 3);
      EXPECT_NEAR(pixel[2], 0.1 * 255, 3);
    }
  }
}

TEST(Camera, LeftIsLeftAndDownIsDown) {
  const World world(box("1 0.5 0.5", "0.1 0.3 0.5", "0 1 0") +
                    box("1 -0.5 0.5", "0.1 0.3 0.5", "0 0 1"));
  const vehicle::Vehicle vehicle = world.vehicle();
  Camera camera(vehicle, {.size = {80, 60}});
  const Image& image = camera.look(vehicle);
  const Colour left = at(image, 20, 30);
  const Colour right = at(image, 60, 30);
  EXPECT_GT(left[1], 200);
  EXPECT_LT(left[2], 50);
  EXPECT_GT(right[2], 200);
  EXPECT_LT(right[1], 50);
  EXPECT_NEAR(at(image, 40, 59)[0], 127, 3) << "the floor";
}

TEST(Camera, ProjectsAsAPinholeOfItsFieldOfView) {
  for (const double field : {40.0, 80.0, 120.0}) {
    const CameraOptions options{.size = {321, 121}, .field_of_view_deg = field};
    EXPECT_NEAR(160.5 / focal_length(options), std::tan(field * std::numbers::pi / 360), 1e-12);
    for (const double degrees : {-0.4 * field, 0.0, 0.2 * field}) {
      const double angle = degrees * std::numbers::pi / 180;  // to the right
      const double x = kCameraAhead + 1.5 * std::cos(angle);
      const double y = -1.5 * std::sin(angle);
      const World world("<geom type=\"cylinder\" size=\"0.02 0.3\" rgba=\"1 0 0 1\" pos=\"" +
                        std::to_string(x) + " " + std::to_string(y) + " 0.3\"/>");
      const vehicle::Vehicle vehicle = world.vehicle();
      Camera camera(vehicle, options);
      const auto columns = columns_of(camera.look(vehicle), 0, 60);
      ASSERT_FALSE(columns.empty()) << field << " " << degrees;
      const double middle = 0.5 * (columns.front() + columns.back()) + 0.5;
      EXPECT_NEAR(middle, 160.5 + focal_length(options) * std::tan(angle), 1.0)
          << field << " " << degrees;
    }
  }
}

TEST(Camera, PixelsAreSquareAndTheHorizonIsInTheMiddle) {
  const double focal = focal_length({.size = {320, 240}, .field_of_view_deg = 80});
  // A wall's foot, at height 0, so far away.
  const World world(box("2.1 0 1", "0.1 3 1", "1 0 0"));
  const vehicle::Vehicle vehicle = world.vehicle();
  Camera camera(vehicle, {.size = {320, 240}, .field_of_view_deg = 80});
  const Image& image = camera.look(vehicle);
  std::uint32_t row = 120;
  while (row < 240 && at(image, 160, row)[0] > 200) ++row;
  EXPECT_NEAR(row, 120 + focal * kCameraHeight / (2.0 - kCameraAhead), 1.0);
}

TEST(Camera, TurnsWithTheVehicle) {
  const World world(box("2 0 0.5", "0.1 0.1 0.5", "1 0 0"));
  vehicle::Vehicle vehicle = world.vehicle();
  Camera camera(vehicle, {.size = {160, 40}});
  const auto before = columns_of(camera.look(vehicle), 0, 20);
  vehicle.command(0, 0.3);
  vehicle.step(1000 * kMs);
  const auto after = columns_of(camera.look(vehicle), 0, 20);
  ASSERT_FALSE(before.empty() || after.empty());
  EXPECT_GT(after.front(), before.back()) << "turned to the left, so things move to the right";
}

TEST(Camera, SameStateSameBytesOnAnyThread) {
  const auto look = [] {
    vehicle::Vehicle vehicle({"phototaxis", 4});
    vehicle.command(0.3, 0.4);
    vehicle.step(2000 * kMs);
    Camera camera(vehicle, {});
    return camera.look(vehicle).rgb;
  };
  const auto here = look();
  EXPECT_EQ(look(), here);
  std::vector<std::uint8_t> there;
  std::thread([&] { there = look(); }).join();
  EXPECT_EQ(there, here);
}

TEST(Camera, LookingChangesNothing) {
  const auto drive = [](bool look) {
    vehicle::Vehicle vehicle({"arena", 3});
    Camera camera(vehicle, {});
    std::vector<double> trace;
    vehicle.command(0.6, 0.4);
    for (int i = 0; i < 40; ++i) {
      vehicle.step(25 * kMs);
      if (look) camera.look(vehicle);
      const auto odometry = vehicle.odometry();
      trace.insert(trace.end(), {odometry.pose.x_m, odometry.pose.y_m, odometry.pose.theta_rad,
                                 odometry.linear_x_m_s, odometry.angular_z_rad_s});
    }
    for (const float range : vehicle.scan().ranges_m) trace.push_back(range);
    return trace;
  };
  EXPECT_EQ(drive(true), drive(false));
}

TEST(Camera, IsRefusedWhereTheVehicleHasNone) {
  std::ifstream in(vehicle::find_world("spikeloop_vehicle.xml"));
  std::string text{std::istreambuf_iterator<char>(in), {}};
  text.replace(text.find("camera name=\"camera\""), 20, "camera name=\"eye\"");
  const test::TemporaryDirectory directory;
  directory.write("spikeloop_vehicle.xml", text);
  std::ifstream world_in(vehicle::find_world("arena.xml"));
  const std::string path =
      directory.write("world.xml", {std::istreambuf_iterator<char>(world_in), {}});
  const vehicle::Vehicle vehicle({path, 1});
  try {
    Camera camera(vehicle, {});
    FAIL();
  } catch (const ConfigurationError& error) {
    EXPECT_EQ(std::string(error.what()),
              path +
                  ": has no camera 'camera'; write <camera name=\"camera\" pos=\"0.2 0 0.07\" "
                  "xyaxes=\"0 -1 0 0 0 1\"/> into body 'vehicle', or include the shipped vehicle "
                  "[SL0801]");
  }
}

}  // namespace
}  // namespace spikeloop::pictures
