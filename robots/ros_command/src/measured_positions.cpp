#include "measured_positions.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <exception>
#include <limits>

#include "spikeloop/core/log.hpp"
#include "spikeloop/messages/catalog.hpp"

namespace spikeloop::ros_command {
namespace {

constexpr const char* kJointStateType = "sensor_msgs/JointState";

bool holds_joint(const StopRule& rule) {
  return rule.hold && !rule.joint.empty();
}

}  // namespace

std::unique_ptr<MeasuredPositions> MeasuredPositions::subscribe(
    topics::Session& session, const command::CommandSettings& settings,
    command::CommandSink& sink) {
  const bool wanted =
      !settings.joint_states.empty() && std::ranges::any_of(settings.stops, holds_joint);
  return wanted ? std::make_unique<MeasuredPositions>(session, settings, sink) : nullptr;
}

MeasuredPositions::MeasuredPositions(topics::Session& session,
                                     const command::CommandSettings& settings,
                                     command::CommandSink& sink)
    : topic_(settings.joint_states),
      sink_(sink),
      positions_(settings.stops.size(), std::numeric_limits<double>::quiet_NaN()) {
  const auto& catalog = messages::Catalog::builtin(session.dialect());
  for (const StopRule& rule : settings.stops) {
    readers_.emplace_back();
    if (holds_joint(rule)) {
      readers_.back().emplace(catalog, kJointStateType,
                              fmt::format("position[name={}]", rule.joint));
    }
  }
  // Lockstep waits for all messages; in all other cases the newest one counts.
  const bool all = settings.clock == command::CommandClock::lockstep;
  subscriber_ =
      session.subscriber({.topic = topic_,
                          .message_type = kJointStateType,
                          .queue = all ? 0U : 1U,
                          .take = [this](auto message) { take(message); },
                          .refuse =
                              [this](const topics::OtherType& other) {
                                if (!warned_.exchange(true)) {
                                  log::warning("{}; a stop holds the last command", other.text);
                                }
                              }});
}

void MeasuredPositions::take(std::span<const std::byte> message) {
  try {
    std::vector<double> value;
    for (std::size_t i = 0; i < readers_.size(); ++i) {
      value.clear();
      const bool is_there = readers_[i] && readers_[i]->read(message, value) > 0;
      // Several programs may report some of the joints each.
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
