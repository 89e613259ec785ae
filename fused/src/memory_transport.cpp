#include "memory_transport.hpp"

#include "spikeloop/robot/files.hpp"

namespace spikeloop::fused {

MemoryTransport::MemoryTransport(const std::optional<experiment::Robot>& robot,
                                 const std::string& folder) {
  if (!robot) {
    return;
  }
  robot_.emplace(vehicle::Options{robot->world, robot->seed}, folder, messages::Dialect::ros1);
  topics_.subscribe(
      "/cmd_vel", [this](std::span<const std::byte> message, TimeNs) { robot_->command(message); });
}

void MemoryTransport::begin(TimeNs time) {
  if (!robot_) {
    return;
  }
  robot_->publish(time, {[&](auto scan) { topics_.publish("/scan", scan, time); },
                         [&](auto odometry) { topics_.publish("/odom", odometry, time); }});
}

void MemoryTransport::end(TimeNs time) {
  if (robot_) {
    robot_->advance(time);
  }
}

void MemoryTransport::finish() {
  if (robot_) {
    robot_->finish();
  }
}

nlohmann::json MemoryTransport::summary() const {
  if (!robot_) {
    return nlohmann::json::object();
  }
  return robot::summary_of(robot_->statistics());
}

}  // namespace spikeloop::fused
