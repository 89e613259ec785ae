#include "memory_transport.hpp"

#include "sensor_options.hpp"
#include "spikeloop/robot/files.hpp"

namespace spikeloop::fused {

MemoryTransport::MemoryTransport(const std::optional<experiment::Robot>& robot,
                                 const std::string& folder,
                                 const robot::SpectatorOptions& spectators) {
  if (!robot) {
    return;
  }
  robot_.emplace(robot::RobotOptions{.vehicle = {robot->world, robot->seed},
                                     .sensors = sensor_options(*robot),
                                     .spectators = spectators,
                                     .folder = folder});
  for (const robot::SensorTopic& topic : robot_->topics()) {
    names_.push_back(topic.name.starts_with('/') ? topic.name : "/" + topic.name);
  }
  topics_.subscribe(
      "/cmd_vel", [this](std::span<const std::byte> message, TimeNs) { robot_->command(message); });
}

void MemoryTransport::begin(TimeNs time) {
  if (!robot_) {
    return;
  }
  robot_->publish(
      time, [&](std::size_t topic) { return topics_.has(names_[topic]); },
      [&](std::size_t topic, auto message) { topics_.publish(names_[topic], message, time); });
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
