#include "spikeloop/robot/stepped_robot.hpp"

#include <algorithm>

namespace spikeloop::robot {
namespace {

constexpr TimeNs kRowPeriod = 20'000'000;  // of the trajectory

TimeNs next_row(TimeNs time) {
  return (time / kRowPeriod + 1) * kRowPeriod;
}

/// Films see by the camera that is a sensor.
SpectatorOptions spectators_of(const RobotOptions& options) {
  SpectatorOptions spectators = options.spectators;
  if (spectators.film && options.sensors.camera) {
    spectators.film->camera = options.sensors.camera->name;
  }
  return spectators;
}

}  // namespace

std::unique_ptr<vehicle::Simulation> make_robot(const vehicle::Options& vehicle,
                                                const std::optional<vehicle::ModelOptions>& model) {
  if (model) return std::make_unique<vehicle::Simulation>(*model);
  return std::make_unique<vehicle::Vehicle>(vehicle);
}

SteppedRobot::SteppedRobot(const RobotOptions& options)
    : robot_(make_robot(options.vehicle, options.model)),
      sensors_(*robot_, options.sensors),
      spectators_(*robot_, spectators_of(options)),
      command_topic_(*robot_, options.sensors.dialect) {
  if (!options.folder.empty() && robot_->vehicle() != nullptr) {
    write_world(options.folder, *robot_->vehicle(), options.vehicle.seed);
    trajectory_.emplace(options.folder);
  }
}

void SteppedRobot::write_row() {
  const vehicle::Vehicle& vehicle = *robot_->vehicle();
  trajectory_->write(vehicle.odometry(), vehicle.statistics().collisions);
}

void SteppedRobot::publish(TimeNs time, const Wanted& wanted, const Publish& publish) {
  for (std::size_t topic = 0; topic < topics().size(); ++topic) {
    if (sensors_.due(topic, time) && wanted(topic)) {
      publish(topic, sensors_.write(topic, *robot_));
    }
  }
}

/// Stops at every row of the trajectory, and at every picture.
void SteppedRobot::advance(TimeNs time) {
  for (TimeNs now = robot_->time(); now < time;) {
    if (trajectory_ && now % kRowPeriod == 0) write_row();
    const TimeNs next = std::min({time, next_row(now), std::max(now + 1, spectators_.next())});
    robot_->step(next - now);
    spectators_.look(*robot_);
    now = next;
  }
  if (command_) {
    act(*command_);
    command_.reset();
  }
}

void SteppedRobot::finish() {
  if (trajectory_) {
    write_row();
    trajectory_->close();
    trajectory_.reset();
  }
  spectators_.finish(*robot_);
}

}  // namespace spikeloop::robot
