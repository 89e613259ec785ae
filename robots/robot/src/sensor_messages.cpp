// Messages of the sensors beside laser and odometry.
#include <fmt/format.h>

#include <array>
#include <cmath>

#include "spikeloop/robot/messages.hpp"
#include "values.hpp"

namespace spikeloop::robot {
namespace {

using messages::Dialect;
using messages::FieldValue;

std::vector<std::string> with_header(const std::vector<std::string>& paths) {
  std::vector<std::string> all{"header.stamp.secs", "header.stamp.nsecs", "header.frame_id"};
  all.insert(all.end(), paths.begin(), paths.end());
  return all;
}

std::vector<std::string> joint_paths(std::size_t joints) {
  std::vector<std::string> paths;
  for (std::size_t i = 0; i < joints; ++i) paths.push_back(fmt::format("name[{}]", i));
  paths.insert(paths.end(), {"position", "velocity", "effort"});
  return with_header(paths);
}

std::vector<std::string> transform_paths(std::size_t count) {
  std::vector<std::string> paths;
  for (std::size_t i = 0; i < count; ++i) {
    for (const char* field :
         {"header.stamp.secs", "header.stamp.nsecs", "header.frame_id", "child_frame_id",
          "transform.translation.x", "transform.translation.y", "transform.translation.z",
          "transform.rotation.w", "transform.rotation.x", "transform.rotation.y",
          "transform.rotation.z"}) {
      paths.push_back(fmt::format("transforms[{}].{}", i, field));
    }
  }
  return paths;
}

/// All of it must live as long as the values that are made of it.
struct Transform {
  const Stamp& stamp;
  const char* from;
  const char* to;
  const vehicle::Mount& mount;
};

/// In the order of transform_paths().
void add_transform(const Transform& transform, std::vector<FieldValue>& values) {
  values.insert(values.end(), {number(transform.stamp.secs), number(transform.stamp.nsecs),
                               text(transform.from), text(transform.to)});
  for (const double& value : transform.mount.position_m) values.push_back(number(value));
  for (const double& value : transform.mount.orientation) values.push_back(number(value));
}

/// The camera's matrices have capital letters in ROS 1.
std::vector<std::string> camera_info_paths(Dialect dialect) {
  const bool capital = dialect == Dialect::ros1;
  return with_header({"height", "width", "distortion_model", capital ? "D" : "d",
                      capital ? "K" : "k", capital ? "R" : "r", capital ? "P" : "p"});
}

}  // namespace

ImuMessage::ImuMessage(Dialect dialect, std::string frame)
    : Message(
          dialect, kImuType,
          with_header({"orientation.w", "orientation.x", "orientation.y", "orientation.z",
                       "angular_velocity.x", "angular_velocity.y", "angular_velocity.z",
                       "linear_acceleration.x", "linear_acceleration.y", "linear_acceleration.z"})),
      frame_(std::move(frame)) {}

const std::vector<std::byte>& ImuMessage::write(const vehicle::Imu& imu) {
  const Stamp stamp(imu.stamp);
  std::vector<FieldValue> values{number(stamp.secs), number(stamp.nsecs), text(frame_)};
  for (const double& value : imu.orientation) values.push_back(number(value));
  for (const double& value : imu.angular_velocity_rad_s) values.push_back(number(value));
  for (const double& value : imu.linear_acceleration_m_s2) values.push_back(number(value));
  return Message::write(values);
}

JointStateMessage::JointStateMessage(Dialect dialect, std::size_t joints)
    : Message(dialect, kJointStateType, joint_paths(joints)) {}

const std::vector<std::byte>& JointStateMessage::write(const vehicle::JointStates& states) {
  const Stamp stamp(states.stamp);
  std::vector<FieldValue> values{number(stamp.secs), number(stamp.nsecs), text("")};
  for (const std::string& name : states.names) values.push_back(text(name));
  values.insert(values.end(),
                {numbers(states.positions), numbers(states.velocities), numbers(states.efforts)});
  return Message::write(values);
}

TransformMessage::TransformMessage(Dialect dialect)
    : Message(dialect, kTransformType, transform_paths(1)) {}

const std::vector<std::byte>& TransformMessage::write(const vehicle::Odometry& odometry) {
  const double half_turn = odometry.pose.theta_rad / 2;
  const vehicle::Mount mount{{odometry.pose.x_m, odometry.pose.y_m, 0},
                             {std::cos(half_turn), 0, 0, std::sin(half_turn)}};
  std::vector<FieldValue> values;
  const Stamp stamp(odometry.stamp);
  add_transform({stamp, kOdometryFrame, kVehicleFrame, mount}, values);
  return Message::write(values);
}

StaticTransformMessage::StaticTransformMessage(Dialect dialect, const vehicle::Mount& laser,
                                               const std::optional<vehicle::Mount>& camera)
    : Message(dialect, kTransformType, transform_paths(camera ? 2 : 1)),
      laser_(laser),
      camera_(camera) {}

const std::vector<std::byte>& StaticTransformMessage::write(TimeNs time) {
  std::vector<FieldValue> values;
  const Stamp stamp(time);
  add_transform({stamp, kVehicleFrame, kLaserFrame, laser_}, values);
  if (camera_) add_transform({stamp, kVehicleFrame, kCameraFrame, *camera_}, values);
  return Message::write(values);
}

NumbersMessage::NumbersMessage(Dialect dialect) : Message(dialect, kNumbersType, {"data"}) {}

const std::vector<std::byte>& NumbersMessage::write(std::span<const double> values) {
  return Message::write(std::array{numbers(values)});
}

ImageMessage::ImageMessage(Dialect dialect)
    : Message(dialect, kImageType, with_header({"height", "width", "encoding", "step", "data"})) {}

const std::vector<std::byte>& ImageMessage::write(TimeNs time, const pictures::Image& image) {
  const Stamp stamp(time);
  const double height = image.size.height;
  const double width = image.size.width;
  const double step = 3 * width;
  return Message::write(std::array{number(stamp.secs), number(stamp.nsecs), text(kCameraFrame),
                                   number(height), number(width), text("rgb8"), number(step),
                                   FieldValue{.bytes = std::as_bytes(std::span(image.rgb))}});
}

CameraInfoMessage::CameraInfoMessage(Dialect dialect)
    : Message(dialect, kCameraInfoType, camera_info_paths(dialect)) {}

const std::vector<std::byte>& CameraInfoMessage::write(TimeNs time,
                                                       const pictures::CameraOptions& camera) {
  const Stamp stamp(time);
  const double height = camera.size.height;
  const double width = camera.size.width;
  const double focal = pictures::focal_length(camera);
  // The middle of the picture, where pixel 0 has its middle at 0.
  const double x = (width - 1) / 2;
  const double y = (height - 1) / 2;
  const std::array<double, 5> distortion{};
  const std::array<double, 9> intrinsic{focal, 0, x, 0, focal, y, 0, 0, 1};
  const std::array<double, 9> rectification{1, 0, 0, 0, 1, 0, 0, 0, 1};
  const std::array<double, 12> projection{focal, 0, x, 0, 0, focal, y, 0, 0, 0, 1, 0};
  return Message::write(std::array{number(stamp.secs), number(stamp.nsecs), text(kCameraFrame),
                                   number(height), number(width), text("plumb_bob"),
                                   numbers(distortion), numbers(intrinsic), numbers(rectification),
                                   numbers(projection)});
}

}  // namespace spikeloop::robot
