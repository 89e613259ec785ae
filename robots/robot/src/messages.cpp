#include "spikeloop/robot/messages.hpp"

#include <array>
#include <cmath>

#include "values.hpp"

namespace spikeloop::robot {
namespace {

using messages::Catalog;
using messages::Dialect;
using messages::FieldValue;

}  // namespace

Message::Message(Dialect dialect, const char* type, const std::vector<std::string>& paths)
    : writer_(Catalog::builtin(dialect), type, paths) {}

const std::vector<std::byte>& Message::write(std::span<const FieldValue> values) {
  writer_.write(values, bytes_);
  return bytes_;
}

ScanMessage::ScanMessage(Dialect dialect)
    : Message(dialect, kScanType,
              {"header.stamp.secs", "header.stamp.nsecs", "header.frame_id", "angle_min",
               "angle_max", "angle_increment", "scan_time", "range_min", "range_max", "ranges"}) {}

const std::vector<std::byte>& ScanMessage::write(const vehicle::LaserScan& scan) {
  const Stamp stamp(scan.stamp);
  const std::array<double, 6> limits{scan.angle_min_rad,       scan.angle_max_rad,
                                     scan.angle_increment_rad, scan.scan_time_s,
                                     scan.range_min_m,         scan.range_max_m};
  const std::vector<double> ranges(scan.ranges_m.begin(), scan.ranges_m.end());
  return Message::write(std::array{number(stamp.secs), number(stamp.nsecs), text(kLaserFrame),
                                   number(limits[0]), number(limits[1]), number(limits[2]),
                                   number(limits[3]), number(limits[4]), number(limits[5]),
                                   numbers(ranges)});
}

OdometryMessage::OdometryMessage(Dialect dialect)
    : Message(dialect, kOdometryType,
              {"header.stamp.secs", "header.stamp.nsecs", "header.frame_id", "child_frame_id",
               "pose.pose.position.x", "pose.pose.position.y", "pose.pose.orientation.z",
               "pose.pose.orientation.w", "twist.twist.linear.x", "twist.twist.linear.y",
               "twist.twist.angular.z"}) {}

const std::vector<std::byte>& OdometryMessage::write(const vehicle::Odometry& odometry) {
  const Stamp stamp(odometry.stamp);
  const double half_turn = odometry.pose.theta_rad / 2;
  const double z = std::sin(half_turn);
  const double w = std::cos(half_turn);
  return Message::write(std::array{number(stamp.secs), number(stamp.nsecs), text(kOdometryFrame),
                                   text(kVehicleFrame), number(odometry.pose.x_m),
                                   number(odometry.pose.y_m), number(z), number(w),
                                   number(odometry.linear_x_m_s), number(odometry.linear_y_m_s),
                                   number(odometry.angular_z_rad_s)});
}

ClockMessage::ClockMessage(Dialect dialect)
    : Message(dialect, kClockType, {"clock.secs", "clock.nsecs"}) {}

const std::vector<std::byte>& ClockMessage::write(TimeNs time) {
  const Stamp stamp(time);
  return Message::write(std::array{number(stamp.secs), number(stamp.nsecs)});
}

}  // namespace spikeloop::robot
