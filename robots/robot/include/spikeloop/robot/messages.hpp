// The robot's data as messages of ROS, 1 or 2.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "spikeloop/messages/dialect.hpp"
#include "spikeloop/messages/field_path.hpp"
#include "spikeloop/messages/message_writer.hpp"
#include "spikeloop/pictures/camera.hpp"
#include "spikeloop/vehicle/vehicle.hpp"

namespace spikeloop::robot {

inline constexpr const char* kScanType = "sensor_msgs/LaserScan";
inline constexpr const char* kOdometryType = "nav_msgs/Odometry";
inline constexpr const char* kImuType = "sensor_msgs/Imu";
inline constexpr const char* kJointStateType = "sensor_msgs/JointState";
inline constexpr const char* kTransformType = "tf2_msgs/TFMessage";
inline constexpr const char* kNumbersType = "std_msgs/Float64MultiArray";
inline constexpr const char* kImageType = "sensor_msgs/Image";
inline constexpr const char* kCameraInfoType = "sensor_msgs/CameraInfo";
inline constexpr const char* kClockType = "rosgraph_msgs/Clock";
inline constexpr const char* kTwistType = "geometry_msgs/Twist";

/// Frames: the arena's; the vehicle's (x ahead, y left, z up); the laser's; the camera's optical
/// one (x right, y down, z into the picture).
inline constexpr const char* kOdometryFrame = "odom";
inline constexpr const char* kVehicleFrame = "base_link";
inline constexpr const char* kLaserFrame = "laser";
inline constexpr const char* kCameraFrame = "camera_optical";

/// One message type with fixed fields in a fixed order. The bytes hold until the next write.
class Message {
 public:
  Message(messages::Dialect dialect, const char* type, const std::vector<std::string>& paths);

 protected:
  const std::vector<std::byte>& write(std::span<const messages::FieldValue> values);

 private:
  messages::MessageWriter writer_;
  std::vector<std::byte> bytes_;
};

class ScanMessage : Message {
 public:
  explicit ScanMessage(messages::Dialect dialect);
  const std::vector<std::byte>& write(const vehicle::LaserScan& scan);
};

/// Pose in frame "odom" (the arena's own), twist in "base_link".
class OdometryMessage : Message {
 public:
  explicit OdometryMessage(messages::Dialect dialect);
  const std::vector<std::byte>& write(const vehicle::Odometry& odometry);
};

/// As REP 145 has it. No noise, so all covariances are 0: not known.
class ImuMessage : Message {
 public:
  explicit ImuMessage(messages::Dialect dialect, std::string frame = kVehicleFrame);
  const std::vector<std::byte>& write(const vehicle::Imu& imu);

 private:
  std::string frame_;
};

class JointStateMessage : Message {
 public:
  JointStateMessage(messages::Dialect dialect, std::size_t joints);
  const std::vector<std::byte>& write(const vehicle::JointStates& states);
};

/// odom to base_link, as the odometry says.
class TransformMessage : Message {
 public:
  explicit TransformMessage(messages::Dialect dialect);
  const std::vector<std::byte>& write(const vehicle::Odometry& odometry);
};

/// What does not move: base_link to laser and to camera_optical.
class StaticTransformMessage : Message {
 public:
  /// @param camera nothing: the vehicle has none
  StaticTransformMessage(messages::Dialect dialect, const vehicle::Mount& laser,
                         const std::optional<vehicle::Mount>& camera);
  const std::vector<std::byte>& write(TimeNs time);

 private:
  vehicle::Mount laser_;
  std::optional<vehicle::Mount> camera_;
};

/// The numbers of a sensor, as an array.
class NumbersMessage : Message {
 public:
  explicit NumbersMessage(messages::Dialect dialect);
  const std::vector<std::byte>& write(std::span<const double> values);
};

/// Encoding rgb8, in frame "camera_optical".
class ImageMessage : Message {
 public:
  explicit ImageMessage(messages::Dialect dialect);
  const std::vector<std::byte>& write(TimeNs stamp, const pictures::Image& image);
};

/// A pinhole without distortion ("plumb_bob" of zeros).
class CameraInfoMessage : Message {
 public:
  explicit CameraInfoMessage(messages::Dialect dialect);
  const std::vector<std::byte>& write(TimeNs stamp, const pictures::CameraOptions& camera);
};

class ClockMessage : Message {
 public:
  explicit ClockMessage(messages::Dialect dialect);
  const std::vector<std::byte>& write(TimeNs time);
};

}  // namespace spikeloop::robot
