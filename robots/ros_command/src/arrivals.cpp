#include "spikeloop/ros_command/arrivals.hpp"

#include "spikeloop/core/pacer.hpp"

namespace spikeloop::ros_command {

Arrivals::Arrivals(topics::Session& session, const std::string& topic,
                   const std::string& message_type)
    : subscriber_(session.subscriber(
          {.topic = topic, .message_type = message_type, .queue = 1, .take = [this](auto) {
             newest_ = wall_now();
           }})) {}

std::vector<EndpointPort> Arrivals::ports() const {
  return {{"out", PortKind::signal, 1}};
}

void Arrivals::receive(const Step& step) {
  const TimeNs newest = newest_;
  if (newest != seen_) {
    seen_ = newest;
    const SignalOutput out = step.signal_output();
    out.values()[0] = to_seconds(newest);
    out.commit();
  }
}

}  // namespace spikeloop::ros_command
