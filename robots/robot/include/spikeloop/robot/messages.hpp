// The vehicle's data as messages of ROS 1 or 2.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "spikeloop/messages/dialect.hpp"
#include "spikeloop/messages/field_path.hpp"
#include "spikeloop/messages/message_writer.hpp"
#include "spikeloop/vehicle/vehicle.hpp"

namespace spikeloop::robot {

inline constexpr const char* kScanType = "sensor_msgs/LaserScan";
inline constexpr const char* kOdometryType = "nav_msgs/Odometry";
inline constexpr const char* kClockType = "rosgraph_msgs/Clock";
inline constexpr const char* kTwistType = "geometry_msgs/Twist";

/// One message type with fixed fields in a fixed order. The bytes hold until the next write.
class Message {
 public:
  Message(messages::Dialect ros, const char* type, const std::vector<std::string>& paths);

 protected:
  const std::vector<std::byte>& write(std::span<const messages::FieldValue> values);

 private:
  messages::MessageWriter writer_;
  std::vector<std::byte> bytes_;
};

class ScanMessage : Message {
 public:
  explicit ScanMessage(messages::Dialect ros);
  const std::vector<std::byte>& write(const vehicle::LaserScan& scan);
};

/// Pose in frame "odom" (the arena's own), twist in "base_link".
class OdometryMessage : Message {
 public:
  explicit OdometryMessage(messages::Dialect ros);
  const std::vector<std::byte>& write(const vehicle::Odometry& odometry);
};

class ClockMessage : Message {
 public:
  explicit ClockMessage(messages::Dialect ros);
  const std::vector<std::byte>& write(TimeNs time);
};

struct Command {
  double linear_m_s = 0;
  double angular_rad_s = 0;
};

class TwistReader {
 public:
  explicit TwistReader(messages::Dialect ros);
  /// @throws TransportError when the message is too short.
  Command read(std::span<const std::byte> message) const;

 private:
  messages::FieldReader linear_;
  messages::FieldReader angular_;
};

}  // namespace spikeloop::robot
