// The robot's messages, read back field by field, in both dialects of ROS.
#include "spikeloop/robot/sensors.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <set>

#include "spikeloop/messages/field_path.hpp"
#include "spikeloop/robot/messages.hpp"

namespace spikeloop::robot {
namespace {

using messages::Dialect;

constexpr TimeNs kMs = 1'000'000;

class RobotSensors : public testing::TestWithParam<Dialect> {
 protected:
  /// After a second of a bend to the left.
  RobotSensors() : vehicle_({"phototaxis", 4}) {
    vehicle_.command(0.4, 0.5);
    vehicle_.step(1234 * kMs);
    sensors_.emplace(vehicle_,
                     SensorOptions{GetParam(), pictures::CameraOptions{{32, 20}, 10, 90}, true});
  }

  std::size_t index(const std::string& name) const {
    const auto& topics = sensors_->topics();
    for (std::size_t i = 0; i < topics.size(); ++i) {
      if (topics[i].name == name) return i;
    }
    ADD_FAILURE() << "no topic " << name;
    return 0;
  }
  std::vector<double> read(const std::string& topic, const std::string& path) {
    const std::size_t i = index(topic);
    std::vector<double> values;
    messages::FieldReader(messages::Catalog::builtin(GetParam()), sensors_->topics()[i].type, path)
        .read(sensors_->write(i, vehicle_), values);
    return values;
  }
  double one(const std::string& topic, const std::string& path) {
    const auto values = read(topic, path);
    EXPECT_EQ(values.size(), 1U) << topic << " " << path;
    return values.empty() ? NAN : values[0];
  }
  bool holds(const std::string& topic, const std::string& words) {
    const auto bytes = sensors_->write(index(topic), vehicle_);
    return std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size()).find(words) !=
           std::string::npos;
  }

  vehicle::Vehicle vehicle_;
  std::optional<Sensors> sensors_;
};

TEST_P(RobotSensors, TopicsTypesAndPeriods) {
  std::map<std::string, std::pair<std::string, TimeNs>> found;
  for (const SensorTopic& topic : sensors_->topics()) {
    found[topic.name] = {topic.type, topic.period / kMs};
  }
  const std::map<std::string, std::pair<std::string, TimeNs>> expected{
      {"scan", {"sensor_msgs/LaserScan", 50}},
      {"odom", {"nav_msgs/Odometry", 20}},
      {"imu", {"sensor_msgs/Imu", 10}},
      {"joint_states", {"sensor_msgs/JointState", 20}},
      {"/tf", {"tf2_msgs/TFMessage", 20}},
      {"/tf_static", {"tf2_msgs/TFMessage", 0}},
      {"light", {"std_msgs/Float64MultiArray", 20}},
      {"camera/image_raw", {"sensor_msgs/Image", 100}},
      {"camera/camera_info", {"sensor_msgs/CameraInfo", 100}}};
  EXPECT_EQ(found, expected);

  const vehicle::Vehicle dark({"arena", 4});
  const Sensors few(dark, {.dialect = GetParam()});
  EXPECT_EQ(few.topics().size(), 6U) << "no lamps, no camera";
}

TEST_P(RobotSensors, EveryMessageHasItsTime) {
  for (const char* topic :
       {"scan", "odom", "imu", "joint_states", "camera/image_raw", "camera/camera_info"}) {
    EXPECT_EQ(one(topic, "header.stamp.secs"), 1) << topic;
    EXPECT_EQ(one(topic, "header.stamp.nsecs"), 234e6) << topic;
  }
}

TEST_P(RobotSensors, StampsBeginWhereTheyAreTold) {
  sensors_->begin_stamps(1'800'000'000 * kNsPerSecond + 900 * kMs);
  for (const char* path :
       {"scan header.stamp", "odom header.stamp", "imu header.stamp", "joint_states header.stamp",
        "camera/image_raw header.stamp", "camera/camera_info header.stamp",
        "/tf transforms[0].header.stamp", "/tf_static transforms[0].header.stamp"}) {
    const std::string text = path;
    const auto space = text.find(' ');
    const std::string topic = text.substr(0, space);
    const std::string stamp = text.substr(space + 1);
    EXPECT_EQ(one(topic, stamp + ".secs"), 1'800'000'002) << path;
    EXPECT_EQ(one(topic, stamp + ".nsecs"), 134e6) << path;
  }
  EXPECT_TRUE(sensors_->due(index("scan"), 0)) << "what is due goes by simulated time";
  EXPECT_FALSE(sensors_->due(index("scan"), 49 * kMs));
  EXPECT_TRUE(sensors_->due(index("scan"), 50 * kMs));
}

TEST_P(RobotSensors, TheInertialUnitsNumbersAreTheVehicles) {
  const vehicle::Imu imu = vehicle_.imu();
  EXPECT_EQ(one("imu", "orientation.w"), imu.orientation[0]);
  EXPECT_EQ(one("imu", "orientation.z"), imu.orientation[3]);
  EXPECT_EQ(one("imu", "angular_velocity.z"), imu.angular_velocity_rad_s[2]);
  EXPECT_EQ(one("imu", "linear_acceleration.x"), imu.linear_acceleration_m_s2[0]);
  EXPECT_EQ(one("imu", "linear_acceleration.y"), imu.linear_acceleration_m_s2[1]);
  EXPECT_NEAR(one("imu", "linear_acceleration.z"), 9.81, 0.2);
  EXPECT_TRUE(holds("imu", "base_link"));
}

TEST_P(RobotSensors, WheelsHaveNames) {
  const vehicle::JointStates wheels = vehicle_.joint_states();
  EXPECT_EQ(read("joint_states", "position"), wheels.positions);
  EXPECT_EQ(read("joint_states", "velocity"), wheels.velocities);
  EXPECT_EQ(read("joint_states", "effort"), wheels.efforts);
  for (const std::string& name : wheels.names) EXPECT_TRUE(holds("joint_states", name));
}

TEST_P(RobotSensors, TransformsAreTheOdometry) {
  for (const char* field : {"x", "y"}) {
    EXPECT_EQ(one("/tf", std::string("transforms[0].transform.translation.") + field),
              one("odom", std::string("pose.pose.position.") + field));
  }
  for (const char* field : {"x", "y", "z", "w"}) {
    EXPECT_EQ(one("/tf", std::string("transforms[0].transform.rotation.") + field),
              one("odom", std::string("pose.pose.orientation.") + field));
  }
  EXPECT_EQ(one("/tf", "transforms[0].header.stamp.nsecs"), 234e6);
  EXPECT_EQ(read("/tf", "transforms.transform.translation.x").size(), 1u) << "what moves, alone";
  EXPECT_TRUE(holds("/tf", "odom") && holds("/tf", "base_link") && !holds("/tf", "laser"));
}

TEST_P(RobotSensors, WhatDoesNotMoveIsToldOnce) {
  const char* const topic = "/tf_static";
  EXPECT_EQ(one(topic, "transforms[child_frame_id=laser].transform.translation.x"), 0.10);
  EXPECT_EQ(one(topic, "transforms[child_frame_id=laser].transform.translation.z"), 0.12);
  EXPECT_EQ(one(topic, "transforms[child_frame_id=camera_optical].transform.translation.x"), 0.195);
  EXPECT_EQ(read(topic, "transforms.transform.translation.x").size(), 2u);
  EXPECT_TRUE(holds(topic, "base_link") && !holds(topic, "odom"));
  EXPECT_TRUE(sensors_->topics()[index(topic)].latched());
  EXPECT_FALSE(sensors_->topics()[index("/tf")].latched());
  EXPECT_TRUE(sensors_->due(index(topic), 0));
  for (TimeNs time = 0; time < 100 * kMs; time += kMs)
    EXPECT_FALSE(sensors_->due(index(topic), time));
}

TEST_P(RobotSensors, LightIsLeftThenRight) {
  const auto light = vehicle_.light();
  ASSERT_TRUE(light);
  EXPECT_EQ(read("light", "data"), (std::vector<double>{light->left_lux, light->right_lux}));
}

TEST_P(RobotSensors, PicturesHaveTheirSizeAndTheCamerasGeometry) {
  EXPECT_EQ(one("camera/image_raw", "width"), 32);
  EXPECT_EQ(one("camera/image_raw", "height"), 20);
  EXPECT_EQ(one("camera/image_raw", "step"), 96);
  EXPECT_EQ(read("camera/image_raw", "data"), std::vector<double>(32 * 20 * 3, 0.0))
      << "blind, so it is black";
  EXPECT_TRUE(holds("camera/image_raw", "rgb8"));
  EXPECT_TRUE(holds("camera/image_raw", "camera_optical"));
  // 90 degrees: the focal length is half the width.
  const std::string k = GetParam() == Dialect::ros1 ? "K" : "k";
  const auto matrix = read("camera/camera_info", k);
  ASSERT_EQ(matrix.size(), 9U);
  EXPECT_NEAR(matrix[0], 16, 1e-9);
  EXPECT_EQ(matrix[2], 15.5);
  EXPECT_NEAR(matrix[4], 16, 1e-9);
  EXPECT_EQ(matrix[5], 9.5);
}

TEST(ImageMessage, KeepsEveryByte) {
  pictures::Image image{{3, 2}, {}};
  for (int i = 0; i < 18; ++i) image.rgb.push_back(static_cast<std::uint8_t>(13 * i));
  for (const Dialect dialect : {Dialect::ros1, Dialect::ros2}) {
    ImageMessage message(dialect);
    std::vector<double> values;
    messages::FieldReader(messages::Catalog::builtin(dialect), kImageType, "data")
        .read(message.write(0, image), values);
    EXPECT_EQ(values, std::vector<double>(image.rgb.begin(), image.rgb.end()));
  }
}

TEST_P(RobotSensors, AreDueAtEveryMultipleOfTheirPeriodOnce) {
  Sensors fresh(vehicle_, {.dialect = GetParam()});
  EXPECT_TRUE(fresh.due(0, 0));
  EXPECT_FALSE(fresh.due(0, 0));
  EXPECT_FALSE(fresh.due(0, 49 * kMs));
  EXPECT_TRUE(fresh.due(0, 53 * kMs));
  EXPECT_FALSE(fresh.due(0, 99 * kMs));
  EXPECT_TRUE(fresh.due(0, 100 * kMs));
  EXPECT_TRUE(fresh.due(0, 750 * kMs)) << "those in between are left out";
  EXPECT_FALSE(fresh.due(0, 751 * kMs));
}

INSTANTIATE_TEST_SUITE_P(Both, RobotSensors, testing::Values(Dialect::ros1, Dialect::ros2));

}  // namespace
}  // namespace spikeloop::robot
