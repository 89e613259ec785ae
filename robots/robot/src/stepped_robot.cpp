#include "spikeloop/robot/stepped_robot.hpp"

#include <algorithm>

namespace spikeloop::robot {
namespace {

constexpr TimeNs kRowPeriod = 20'000'000;  // of the trajectory

TimeNs next_row(TimeNs time) {
  return (time / kRowPeriod + 1) * kRowPeriod;
}

}  // namespace

SteppedRobot::SteppedRobot(const RobotOptions& options)
    : vehicle_(options.vehicle),
      sensors_(vehicle_, options.sensors),
      spectators_(vehicle_, options.spectators),
      twist_(options.sensors.dialect) {
  if (!options.folder.empty()) {
    write_world(options.folder, vehicle_, options.vehicle.seed);
    trajectory_.emplace(options.folder);
  }
}

void SteppedRobot::publish(TimeNs time, const Wanted& wanted, const Publish& publish) {
  for (std::size_t topic = 0; topic < topics().size(); ++topic) {
    if (sensors_.due(topic, time) && wanted(topic)) {
      publish(topic, sensors_.write(topic, vehicle_));
    }
  }
}

/// Stops at every row of the trajectory, and at every picture.
void SteppedRobot::advance(TimeNs time) {
  for (TimeNs now = vehicle_.time(); now < time;) {
    if (trajectory_ && now % kRowPeriod == 0) {
      trajectory_->write(vehicle_.odometry(), vehicle_.statistics().collisions);
    }
    const TimeNs next = std::min({time, next_row(now), std::max(now + 1, spectators_.next())});
    vehicle_.step(next - now);
    spectators_.look(vehicle_);
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
  spectators_.finish(vehicle_);
}

}  // namespace spikeloop::robot
