#include "spikeloop/ros_command/command_endpoint.hpp"

#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>

#include "command_topics.hpp"
#include "diagnostics.hpp"
#include "spikeloop/core/log.hpp"
#include "spikeloop/core/pacer.hpp"
#include "spikeloop/guard/guard_timer.hpp"
#include "spikeloop/messages/catalog.hpp"
#include "spikeloop/status/signals.hpp"
#include "spikeloop/status/status.hpp"
#include "spikeloop/topics/names.hpp"

namespace spikeloop::ros_command {
namespace {

/// Time for a robot to subscribe before a warning.
constexpr TimeNs kPatience = 2 * kNsPerSecond;

constexpr TimeNs kCheckPeriod = kNsPerSecond / 10;

/// Longest wait for the guard's connection to a robot that has subscribed: over Fast DDS two nodes
/// discover each other within two seconds.
constexpr TimeNs kGuardPatience = 3 * kNsPerSecond;

/// Time in which the first measured positions arrive.
constexpr TimeNs kPositionPatience = kNsPerSecond;

/// The message that stops the robot; empty if no position is known, so that nothing is sent.
std::vector<std::byte> stop_message(const topics::Publisher& publisher,
                                    std::span<const double> values) {
  const auto unknown = [](double value) { return std::isnan(value); };
  return std::ranges::all_of(values, unknown) ? std::vector<std::byte>{}
                                              : publisher.message(values);
}

guard::Hello guard_hello(const topics::Session& session, const command::CommandSettings& settings,
                         const topics::Publisher& publisher) {
  const auto first_stop = command::CommandChannel(settings, {}).stop_values(0);
  return {.process = settings.process,
          .topic = session.whole_topic(settings.topic),
          .message_type = settings.message_type,
          .ros = topics::version_of(session.dialect()),
          .place = session.place(),
          .watchdog = settings.watchdog,
          .stop = stop_message(publisher, first_stop)};
}

/// Node that subscribes to the commands with another type; nullopt if there is none.
std::optional<topics::Partner> subscriber_of_other_type(const topics::Session& session,
                                                        const std::string& topic,
                                                        const std::string& message_type) {
  const std::string type =
      messages::Catalog::for_type(session.dialect(), message_type).full_name(message_type);
  const auto partners = session.subscribers(topic);
  const auto other = std::ranges::find_if(
      partners, [&](const topics::Partner& partner) { return partner.type != type; });
  return other == partners.end() ? std::nullopt : std::optional(*other);
}

constexpr std::string_view kManual = "_manual";

/// Topic of manual commands. The default is remapped as the topic of the commands, so that two
/// robots have different topics. A remapping rule for the topic itself has priority.
std::string manual_topic(const topics::Session& session, const std::string& commands,
                         const std::string& manual) {
  if (manual.empty() || manual != commands + std::string(kManual)) {
    return manual;
  }
  constexpr std::string_view kNoRule = "_as_it_is";
  std::string plain = session.whole_topic(commands + std::string(kNoRule));
  plain.resize(plain.size() - kNoRule.size());
  const bool has_rule = session.whole_topic(manual) != plain + std::string(kManual);
  return has_rule ? manual : session.whole_topic(commands) + std::string(kManual);
}

/// Settings with the names of topics after remapping.
command::CommandSettings as_in_ros(const topics::Session& session,
                                   command::CommandSettings settings) {
  if (!session.local()) {
    settings.manual.topic = manual_topic(session, settings.topic, settings.manual.topic);
    for (auto& sensor : settings.sensors) {
      sensor.topic = session.whole_topic(sensor.topic);
    }
  }
  return settings;
}

}  // namespace

CommandEndpoint::CommandEndpoint(topics::Session& session, const command::CommandSettings& settings,
                                 topics::Keep keep)
    : session_(session),
      settings_(as_in_ros(session, settings)),
      topic_(session.local() ? settings.topic : session.whole_topic(settings.topic)),
      waits_for_guard_(!session.local()),
      publisher_(session, settings.topic, settings.message_type, settings.fields,
                 settings.clock == command::CommandClock::wall),
      keep_(std::move(keep)),
      supervised_(session.local() ? nullptr : std::make_unique<status::SupervisedRobot>()),
      guard_(session.local()
                 ? nullptr
                 : std::make_unique<guard::Link>(guard_hello(session, settings, publisher_))),
      diagnostics_(settings.clock == command::CommandClock::lockstep
                       ? nullptr
                       : std::make_unique<Diagnostics>(session, settings.topic)),
      sink_(settings_, *this, !session.local()),
      topics_(std::make_unique<CommandTopics>(session, settings.message_type, settings.fields,
                                              settings_, sink_)),
      positions_(settings.joint_states.empty()
                     ? nullptr
                     : std::make_unique<MeasuredPositions>(session, settings, sink_)),
      on_termination_(session.local() ? nullptr : std::make_unique<status::TerminationHook>([this] {
        sink_.stop(command::StopReason::terminated);
      })),
      on_stop_(session.local() || settings.clock == command::CommandClock::lockstep
                   ? nullptr
                   : std::make_unique<status::StopHook>(
                         [this] { sink_.stop(command::StopReason::ended); })) {}

CommandEndpoint::~CommandEndpoint() = default;

/// Called by any thread that stops the robot. Must not wait for a disk.
void CommandEndpoint::publish(std::span<const double> values) {
  // A robot may have subscribed after begin_tick().
  if (waits_for_guard_ && sink_.drives() && publisher_.raw().has_subscribers()) {
    return;
  }
  const auto message = publisher_.publish(values);
  ++count_;
  if (keep_) {
    const std::lock_guard lock(sending_);
    sent_.emplace_back(message.begin(), message.end());
  }
}

void CommandEndpoint::finish() {
  leave_to_guard_if_dead();
  publisher_.raw().drain();
  if (guard_) {
    guard_->done();
    // A session that has ended sends no stop command; then only the guard can stop the robot.
    if (session_.alive()) {
      supervised_->release();
    }
  }
}

TimeNs CommandEndpoint::beat(TimeNs now) {
  leave_to_guard_if_dead();
  // The guard must send the same stop command as this process.
  if (std::ranges::any_of(settings_.stops, &StopRule::hold)) {
    guard_->set_stop(stop_message(publisher_, sink_.stop_values()));
  }
  return std::min(guard_->beat(now),
                  diagnostics_ ? diagnostics_->publish(now, condition(), sink_) : kNever);
}

std::optional<command::StopReason> CommandEndpoint::lost_supervision(TimeNs now) {
  switch (supervised_->state(now, guard::deadline_for(settings_.watchdog))) {
    case status::SupervisedRobot::State::suspended:
      return command::StopReason::suspended;
    case status::SupervisedRobot::State::silent:
      return command::StopReason::unsupervised;
    case status::SupervisedRobot::State::supervised:
      break;
  }
  // Until the guard is connected to the robot, no command is sent (see may_begin()), so that a
  // missing connection is not a reason to stop.
  const bool robot_subscribes = !waits_for_guard_ && publisher_.raw().has_subscribers();
  return settings_.guard_required && !guard_->guards(robot_subscribes)
             ? std::optional(command::StopReason::unguarded)
             : std::nullopt;
}

void CommandEndpoint::keep_sent() {
  if (!keep_) {
    return;
  }
  std::vector<std::vector<std::byte>> messages;
  {
    const std::lock_guard lock(sending_);
    messages.swap(sent_);
  }
  for (const auto& message : messages) {
    keep_(ended_, message);
  }
}

void CommandEndpoint::stop(command::StopReason reason) {
  if (reason == command::StopReason::ended && !status::stop_requested()) {
    stood_at_end_ = sink_.missing_data();
  }
  sink_.stop(reason);
  keep_sent();
}

nlohmann::json CommandEndpoint::summary() const {
  nlohmann::json summary = sink_.summary();
  if (!stood_at_end_.empty()) {
    summary[status::kStoodAtEnd] = stood_at_end_;
  }
  return summary;
}

bool CommandEndpoint::begin_tick(TimeNs end) {
  if (!may_begin() || awaits_position()) {
    return false;
  }
  ended_ = end;
  session_.require_alive();
  return true;
}

void CommandEndpoint::end_tick() {
  keep_sent();
  topics_->report_other_types();
  if (positions_) {
    positions_->report_other_types();
  }
  if (count_ != 0 && !session_.local()) {
    check_subscribers();
  }
}

command::Condition CommandEndpoint::condition() const {
  command::Condition condition = sink_.condition();
  using enum command::Condition::Level;
  if (condition.level == ok && !publisher_.raw().has_subscribers()) {
    const std::string misfit = publisher_.raw().misfit();
    return {warning, misfit.empty() ? "no subscriber on '" + topic_ + "'"
                                    : "a subscriber of '" + topic_ + "' requests " + misfit};
  }
  if (condition.level == ok && waits_for_guard_) {
    return {warning, "the robot is not driven before its guard is connected to it"};
  }
  return condition;
}

/// Returns true if commands may be sent: the guard is connected to the robot, or there is no
/// subscriber. Without its connection the guard could not stop the robot. Also waits for the
/// guard's connection to a robot that subscribes later.
bool CommandEndpoint::may_begin() {
  if (!waits_for_guard_) {
    return true;
  }
  if (!publisher_.raw().has_subscribers()) {
    met_at_ = 0;
    return true;
  }
  const TimeNs now = wall_now();
  met_at_ = met_at_ == 0 ? now : met_at_;
  const bool reaches = guard_->reaches_robot();
  if (!reaches && now - met_at_ < kGuardPatience) {
    return false;
  }
  if (!reaches) {
    log::warning(
        "the guard has no subscriber on topic '{}' after {}; the robot is driven nevertheless. "
        "Until the guard is connected, nothing stops the robot when this program is killed or "
        "stopped",
        topic_, format_time(kGuardPatience));
  }
  sink_.restart_commands();
  waits_for_guard_ = false;
  return true;
}

/// A slew rate of a joint's position begins at the measured position, whose first message may
/// arrive after the first command is due.
bool CommandEndpoint::awaits_position() {
  if (!positions_ || positions_->received() != 0 ||
      settings_.clock == command::CommandClock::lockstep) {
    return false;
  }
  bool begins_at_measurement = false;
  for (std::size_t i = 0; i < std::min(settings_.stops.size(), settings_.bounds.size()); ++i) {
    begins_at_measurement = begins_at_measurement || (!settings_.stops[i].joint.empty() &&
                                                      std::isfinite(settings_.bounds[i].slew));
  }
  if (!begins_at_measurement || warned_of_no_position_) {
    return false;
  }
  const TimeNs now = wall_now();
  first_tick_ = first_tick_ == 0 ? now : first_tick_;
  if (now - first_tick_ < kPositionPatience) {
    return true;
  }
  warned_of_no_position_ = true;
  log::warning(
      "no message on topic '{}' within {}, so the measured positions are unknown; the first "
      "command "
      "of '{}' moves the joints without 'slew'",
      positions_->topic(), format_time(kPositionPatience), topic_);
  return false;
}

/// Warns once of subscribers that receive no command, and once if there is no subscriber.
void CommandEndpoint::check_subscribers() {
  const TimeNs now = wall_now();
  if (now - checked_at_ < kCheckPeriod) {
    return;
  }
  checked_at_ = now;
  driven_since_ = driven_since_ == 0 ? now : driven_since_;
  const bool subscribed = publisher_.raw().has_subscribers();
  const auto other = subscriber_of_other_type(session_, topic_, settings_.message_type);
  if (now - driven_since_ < kPatience) {
    return;
  }
  const std::string misfit = publisher_.raw().misfit();
  if (!misfit.empty() && !std::exchange(warned_of_misfit_, true)) {
    log::warning(
        "a subscriber of '{}' gets no command: it requests {}; give it the default quality of "
        "service ('{} info -v {}' prints its node)",
        topic_, misfit, topics::topic_command(session_.dialect()), topic_);
  }
  if (other && !std::exchange(warned_of_type_, true)) {
    log::warning("{} subscribes to '{}' as {} and gets no command of type {}; {}, or another topic",
                 other->node.empty() ? "a node" : "node " + other->node, topic_, other->type,
                 settings_.message_type,
                 topics::remedy_for_type(other->type, settings_.message_type));
  }
  const bool has_reason = warned_of_misfit_ || warned_of_type_ ||
                          session_.has_warned_of_unreachable_node(session_.whole_topic(topic_));
  if (!subscribed && !has_reason && !std::exchange(warned_of_no_subscriber_, true)) {
    log::warning(
        "no subscriber of {} on topic '{}'; the robot will not move. '{} info {}' shows "
        "subscribers and their types",
        settings_.message_type, topic_, topics::topic_command(session_.dialect()), topic_);
  }
}

void CommandEndpoint::leave_to_guard_if_dead() {
  if (guard_ && !session_.alive()) {
    guard_->abandon();
  }
}

}  // namespace spikeloop::ros_command
