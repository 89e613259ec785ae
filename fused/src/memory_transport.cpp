#include "memory_transport.hpp"

#include <utility>

namespace spikeloop::fused {

MemoryTransport::MemoryTransport(std::unique_ptr<robot::Robot> robot) : robot_(std::move(robot)) {
  if (!robot_) {
    return;
  }
  for (const robot::SensorTopic& topic : robot_->topics()) {
    publishers_.push_back(session_.publisher(topic.name, topic.type));
  }
  const robot::CommandDescription command = robot_->command_description();
  commands_ = session_.subscriber({.topic = "/" + command.name,
                                   .message_type = command.type,
                                   .take = [this](auto message) { robot_->command(message); }});
}

void MemoryTransport::begin(TimeNs time) {
  if (robot_) {
    robot_->publish(
        time, [this](std::size_t topic) { return publishers_[topic]->has_subscribers(); },
        [this](std::size_t topic, auto message) { publishers_[topic]->publish(message); });
  }
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
  return robot_ ? robot_->summary() : nlohmann::json::object();
}

}  // namespace spikeloop::fused
