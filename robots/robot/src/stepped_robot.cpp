#include "spikeloop/robot/stepped_robot.hpp"

#include <algorithm>
#include <cmath>

namespace spikeloop::robot {
namespace {

constexpr TimeNs kMs = 1'000'000;
constexpr TimeNs kOdometryPeriod = 20 * kMs;

/// The first multiple of `period` after `time`.
TimeNs next_multiple(TimeNs time, TimeNs period) {
  return (time / period + 1) * period;
}

}  // namespace

SteppedRobot::SteppedRobot(const vehicle::Options& options, const std::string& folder,
                           messages::Dialect ros)
    : vehicle_(options),
      scan_(ros),
      odometry_(ros),
      twist_(ros),
      // A float: to the microsecond, or scans would be due a nanosecond after their tick.
      scan_period_(std::max<TimeNs>(kMs, 1000 * std::llround(vehicle_.scan().scan_time_s * 1e6))) {
  if (!folder.empty()) {
    write_world(folder, vehicle_, options.seed);
    trajectory_.emplace(folder);
  }
}

void SteppedRobot::publish(TimeNs time, const Outputs& outputs) {
  if (time >= next_scan_) {
    outputs.scan(scan_.write(vehicle_.scan()));
    next_scan_ = next_multiple(time, scan_period_);
  }
  if (time >= next_odometry_) {
    outputs.odometry(odometry_.write(vehicle_.odometry()));
    next_odometry_ = next_multiple(time, kOdometryPeriod);
  }
}

/// Stops at every row of the trajectory.
void SteppedRobot::advance(TimeNs time) {
  for (TimeNs now = vehicle_.time(); now < time;) {
    if (trajectory_ && now % kOdometryPeriod == 0) {
      trajectory_->write(vehicle_.odometry(), vehicle_.statistics().collisions);
    }
    const TimeNs next = std::min(time, next_multiple(now, kOdometryPeriod));
    vehicle_.step(next - now);
    now = next;
  }
  if (command_) {
    vehicle_.command(command_->linear_m_s, command_->angular_rad_s);
    command_.reset();
  }
}

void SteppedRobot::finish() {
  if (trajectory_) {
    trajectory_->write(vehicle_.odometry(), vehicle_.statistics().collisions);
    trajectory_->close();
    trajectory_.reset();
  }
}

}  // namespace spikeloop::robot
