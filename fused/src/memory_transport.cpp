#include "memory_transport.hpp"

#include <algorithm>
#include <cmath>

namespace spikeloop::fused {
namespace {

constexpr TimeNs kMs = 1'000'000;
constexpr TimeNs kOdometryPeriod = 20 * kMs;

/// The first multiple of `period` after `time`.
TimeNs next_multiple(TimeNs time, TimeNs period) {
  return (time / period + 1) * period;
}

}  // namespace

MemoryTransport::MemoryTransport(const std::optional<experiment::Robot>& robot,
                                 const std::string& folder) {
  if (!robot) {
    return;
  }
  vehicle_.emplace(vehicle::Options{robot->world, robot->seed});
  scan_period_ = std::max<TimeNs>(kMs, std::llround(vehicle_->scan().scan_time_s * 1e9));
  topics_.subscribe("/cmd_vel", [this](std::span<const std::byte> message, TimeNs) {
    command_ = twist_.read(message);
  });
  if (!folder.empty()) {
    robot::write_world(folder, *vehicle_, robot->seed);
    trajectory_.emplace(folder);
  }
}

void MemoryTransport::begin(TimeNs time) {
  if (!vehicle_) {
    return;
  }
  if (time >= next_scan_) {
    topics_.publish("/scan", scan_.write(vehicle_->scan()), time);
    next_scan_ = next_multiple(time, scan_period_);
  }
  if (time >= next_odometry_) {
    topics_.publish("/odom", odometry_.write(vehicle_->odometry()), time);
    next_odometry_ = next_multiple(time, kOdometryPeriod);
  }
}

void MemoryTransport::end(TimeNs time) {
  if (!vehicle_) {
    return;
  }
  step_robot(time);
  if (command_) {
    vehicle_->command(command_->linear_m_s, command_->angular_rad_s);
    command_.reset();
  }
}

/// Stops at every row of the trajectory.
void MemoryTransport::step_robot(TimeNs time) {
  for (TimeNs now = vehicle_->time(); now < time;) {
    if (trajectory_ && now % kOdometryPeriod == 0) {
      trajectory_->write(vehicle_->odometry(), vehicle_->statistics().collisions);
    }
    const TimeNs next = std::min(time, next_multiple(now, kOdometryPeriod));
    vehicle_->step(next - now);
    now = next;
  }
}

void MemoryTransport::finish() {
  if (trajectory_) {
    trajectory_->write(vehicle_->odometry(), vehicle_->statistics().collisions);
    trajectory_->close();
    trajectory_.reset();
  }
}

nlohmann::json MemoryTransport::summary() const {
  if (!vehicle_) {
    return nlohmann::json::object();
  }
  const auto result = vehicle_->statistics();
  return {{"collisions", result.collisions},
          {"distance_m", result.distance_m},
          {"coverage", result.coverage},
          {"mean_speed_m_s", result.mean_speed_m_s}};
}

}  // namespace spikeloop::fused
