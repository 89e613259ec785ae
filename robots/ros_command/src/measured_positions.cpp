#include "spikeloop/ros_command/measured_positions.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <exception>
#include <limits>

#include "spikeloop/core/log.hpp"
#include "spikeloop/messages/catalog.hpp"

namespace spikeloop::ros_command {
namespace {

constexpr const char* kJointStateType = "sensor_msgs/JointState";

}  // namespace

MeasuredPositions::MeasuredPositions(topics::Session& session,
                                     const command::CommandSettings& settings,
                                     command::CommandSink& sink)
    : topic_(settings.joint_states),
      sink_(sink),
      positions_(settings.stops.size(), std::numeric_limits<double>::quiet_NaN()) {
  const auto& catalog = messages::Catalog::builtin(session.dialect());
  for (const StopRule& rule : settings.stops) {
    readers_.emplace_back();
    if (!rule.joint.empty()) {
      readers_.back().emplace(catalog, kJointStateType,
                              fmt::format("position[name={}]", rule.joint));
    }
  }
  // Lockstep needs all messages; otherwise the newest one is enough.
  const bool all = settings.clock == command::CommandClock::lockstep;
  subscriber_ =
      session.subscriber({.topic = topic_,
                          .message_type = kJointStateType,
                          .queue = all ? 0U : 1U,
                          .take = [this](auto message) { take(message); },
                          .refuse = [this](const auto& other) { other_types_.add(other); }});
}

void MeasuredPositions::report_other_types() {
  while (const auto other = other_types_.take()) {
    log::warning("{}; a stop holds the last command", other->text);
  }
}

void MeasuredPositions::take(std::span<const std::byte> message) {
  try {
    std::vector<double> value;
    for (std::size_t i = 0; i < readers_.size(); ++i) {
      value.clear();
      const bool is_there = readers_[i] && readers_[i]->read(message, value) > 0;
      // Several programs may each publish some of the joints.
      positions_[i] = is_there ? value.front() : std::numeric_limits<double>::quiet_NaN();
    }
    sink_.measure(positions_);
  } catch (const std::exception& error) {
    if (!warned_.exchange(true)) {
      log::warning("topic '{}': {}; a stop holds the last command", topic_, error.what());
    }
  }
  ++received_;
}

}  // namespace spikeloop::ros_command
