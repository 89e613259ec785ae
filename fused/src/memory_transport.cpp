#include "memory_transport.hpp"

#include "robot_options.hpp"
#include "spikeloop/robot/files.hpp"

namespace spikeloop::fused {

MemoryTransport::MemoryTransport(const std::optional<experiment::Robot>& robot,
                                 const std::string& folder,
                                 const robot::SpectatorOptions& spectators) {
  if (!robot) {
    return;
  }
  robot::RobotOptions options = robot_options(*robot);
  options.spectators = spectators;
  options.folder = folder;
  robot_.emplace(options);
  for (const robot::SensorTopic& topic : robot_->topics()) {
    publishers_.push_back(session_.publisher(topic.name, topic.type));
  }
  const robot::CommandTopic& command = robot_->command_topic();
  commands_ = session_.subscriber({.topic = "/" + command.name(),
                                   .message_type = command.type(),
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
  if (!robot_) {
    return nlohmann::json::object();
  }
  return robot::summary_of(robot_->robot());
}

}  // namespace spikeloop::fused
