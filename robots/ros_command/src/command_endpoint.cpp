#include "spikeloop/ros_command/command_endpoint.hpp"

#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <utility>

#include "command_topics.hpp"
#include "diagnostics.hpp"
#include "measured_positions.hpp"
#include "spikeloop/core/log.hpp"
#include "spikeloop/core/pacer.hpp"
#include "spikeloop/guard/guard_timer.hpp"
#include "spikeloop/messages/catalog.hpp"
#include "spikeloop/status/signals.hpp"
#include "spikeloop/status/status.hpp"
#include "spikeloop/topics/names.hpp"

namespace spikeloop::ros_command {
namespace {

/// So long a robot may take to subscribe.
constexpr TimeNs kPatience = 2 * kNsPerSecond;

constexpr TimeNs kLook = kNsPerSecond / 10;

/// So long a robot that hears us may take to hear the guard, too: over Fast DDS two nodes meet
/// within two seconds.
constexpr TimeNs kGuardPatience = 3 * kNsPerSecond;

/// The message that stops the robot; empty if no position is known, so that nothing is sent.
std::vector<std::byte> stop_message(const topics::Publisher& publisher,
                                    std::span<const double> values) {
  const auto unknown = [](double value) { return std::isnan(value); };
  return std::ranges::all_of(values, unknown) ? std::vector<std::byte>{}
                                              : publisher.message(values);
}

/// Before any position is known.
std::vector<double> first_stop(const command::CommandSettings& settings) {
  std::vector<double> values(settings.width, 0.0);
  for (std::size_t i = 0; i < std::min(values.size(), settings.stops.size()); ++i) {
    const StopRule& rule = settings.stops[i];
    values[i] = rule.hold ? std::numeric_limits<double>::quiet_NaN() : rule.value;
  }
  return values;
}

/// What the guard has to know to stop the robot in our place.
guard::Hello guard_hello(const topics::Session& session, const Address& address,
                         const command::CommandSettings& settings,
                         const topics::Publisher& publisher) {
  return {.process = address.process,
          .topic = session.whole_topic(address.topic),
          .message_type = address.message_type,
          .ros = topics::version_of(session.dialect()),
          .place = session.place(),
          .watchdog = settings.watchdog,
          .stop = stop_message(publisher, first_stop(settings))};
}

constexpr std::string_view kManual = "_manual";

/// The topic of manual commands that nobody has named follows that of the commands: two robots
/// whose commands have been remapped have a topic each. A rule for itself wins.
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

/// With topics as ROS has them, for those who look for them there.
command::CommandSettings as_in_ros(const topics::Session& session, const std::string& commands,
                                   command::CommandSettings settings) {
  if (!session.local()) {
    settings.manual.topic = manual_topic(session, commands, settings.manual.topic);
    for (auto& sensor : settings.sensors) {
      sensor.topic = session.whole_topic(sensor.topic);
    }
  }
  return settings;
}

/// The same for what is said of the commands.
Address as_in_ros(const topics::Session& session, Address address) {
  if (!session.local()) {
    address.topic = session.whole_topic(address.topic);
  }
  return address;
}

}  // namespace

CommandEndpoint::CommandEndpoint(topics::Session& session, const Address& address,
                                 const command::CommandSettings& settings, topics::Keep keep)
    : session_(session),
      address_(as_in_ros(session, address)),
      type_(messages::Catalog::for_type(session.dialect(), address.message_type)
                .full_name(address.message_type)),
      waits_for_guard_(!session.local()),
      publisher_(session, address.topic, address.message_type, address.fields,
                 settings.clock == command::CommandClock::wall),
      keep_(std::move(keep)),
      watchdog_(settings.watchdog),
      guard_required_(settings.guard_required),
      holds_(std::ranges::any_of(settings.stops, &StopRule::hold)),
      supervised_(session.local() ? nullptr : std::make_unique<status::SupervisedRobot>()),
      guard_(session.local() ? nullptr
                             : std::make_unique<guard::Link>(
                                   guard_hello(session, address, settings, publisher_))),
      diagnostics_(settings.clock == command::CommandClock::lockstep
                       ? nullptr
                       : std::make_unique<Diagnostics>(session, address.topic)),
      sink_(as_in_ros(session, address.topic, settings), transport()),
      topics_(std::make_unique<CommandTopics>(session, address.message_type, address.fields,
                                              as_in_ros(session, address.topic, settings), sink_)),
      positions_(MeasuredPositions::subscribe(session, settings, sink_)),
      on_termination_(session.local() ? nullptr : std::make_unique<status::TerminationHook>([this] {
        sink_.stop(command::StopReason::terminated);
      })),
      on_stop_(session.local() || settings.clock == command::CommandClock::lockstep
                   ? nullptr
                   : std::make_unique<status::StopHook>(
                         [this] { sink_.stop(command::StopReason::ended); })) {}

CommandEndpoint::~CommandEndpoint() = default;

command::CommandSink::Transport CommandEndpoint::transport() {
  command::CommandSink::Transport transport{
      .publish = [this](auto values) { publish(values); },
      .finish = [this] { finish(); },
      .begin_tick = [this](TimeNs end) { return begin_tick(end); },
      .end_tick = [this] { end_tick(); },
      .watched = !session_.local()};
  if (!session_.local()) {
    transport.interrupted = [] { ::kill(::getpid(), SIGTERM); };
    transport.beat = [this](TimeNs now) { return beat(now); };
    transport.lost_supervision = [this](TimeNs now) { return lost_supervision(now); };
  }
  return transport;
}

/// In whatever thread stops the robot, too, which must never wait for a disk.
void CommandEndpoint::publish(std::span<const double> values) {
  if (drives_unguarded()) {
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
  publisher_.drain();
  if (guard_) {
    guard_->done();
    // A session that has ended sends no zero command; then only the guard can stop the robot.
    if (session_.alive()) {
      supervised_->release();
    }
  }
}

TimeNs CommandEndpoint::beat(TimeNs now) {
  leave_to_guard_if_dead();
  update_guard();
  return std::min(guard_->beat(now), report(now));
}

std::optional<command::StopReason> CommandEndpoint::lost_supervision(TimeNs now) const {
  switch (supervised_->state(now, guard::deadline_for(watchdog_))) {
    case status::SupervisedRobot::State::suspended:
      return command::StopReason::suspended;
    case status::SupervisedRobot::State::silent:
      return command::StopReason::unsupervised;
    case status::SupervisedRobot::State::supervised:
      break;
  }
  // Before the first command the robot stands still anyway, until the guard is connected to it.
  const bool robot_subscribes = !waits_for_guard_ && publisher_.has_subscribers();
  return guard_required_ && !guard_->guards(robot_subscribes)
             ? std::optional(command::StopReason::unguarded)
             : std::nullopt;
}

/// In the loop.
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
  if (!may_begin()) {
    return false;
  }
  ended_ = end;
  session_.require_alive();
  return true;
}

void CommandEndpoint::end_tick() {
  keep_sent();
  topics_->report_other_types();
  if (count_ != 0 && !session_.local()) {
    mind_subscribers();
  }
}

/// In the watch's thread, so also while the loop stands still.
TimeNs CommandEndpoint::report(TimeNs now) {
  return diagnostics_ ? diagnostics_->publish(now, condition(), sink_) : kNever;
}

command::Condition CommandEndpoint::condition() const {
  command::Condition condition = sink_.condition();
  using enum command::Condition::Level;
  if (condition.level == ok && !publisher_.has_subscribers()) {
    const std::string misfit = publisher_.misfit();
    return {warning, misfit.empty()
                         ? "no subscriber on '" + address_.topic + "'"
                         : "a subscriber of '" + address_.topic + "' asks for " + misfit};
  }
  if (condition.level == ok && waits_for_guard_) {
    return {warning, "the robot is not driven before its guard is connected to it"};
  }
  return condition;
}

/// Nobody could stop a robot that its guard has not met. Commands that no robot hears need no
/// guard: one that comes later is waited for, too.
bool CommandEndpoint::may_begin() {
  if (!waits_for_guard_) {
    return true;
  }
  if (!publisher_.has_subscribers()) {
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
        "Until "
        "the guard is connected, nothing stops the robot when this program is killed or stopped",
        address_.topic, format_time(kGuardPatience));
  }
  sink_.begin_anew();
  waits_for_guard_ = false;
  return true;
}

/// The robot may have come since the loop handed over the command.
bool CommandEndpoint::drives_unguarded() const {
  return waits_for_guard_ && sink_.drives() && publisher_.has_subscribers();
}

/// The guard sends what this process would send to stop the robot now.
void CommandEndpoint::update_guard() {
  if (holds_) {
    guard_->set_stop(stop_message(publisher_, sink_.stop_values()));
  }
}

std::string CommandEndpoint::positions_topic() const {
  return positions_ ? positions_->topic() : "";
}

bool CommandEndpoint::positions_have_publisher() const {
  return positions_ && positions_->has_publishers();
}

std::uint64_t CommandEndpoint::positions_received() const {
  return positions_ ? positions_->received() : 0;
}

/// Warns of subscribers that receive no command, and if there is none; each once.
void CommandEndpoint::mind_subscribers() {
  const TimeNs now = wall_now();
  if (now - looked_at_ < kLook) {
    return;
  }
  looked_at_ = now;
  driven_since_ = driven_since_ == 0 ? now : driven_since_;
  const bool subscribed = publisher_.has_subscribers();
  const auto other = subscribed && session_.dialect() == messages::Dialect::ros1
                         ? std::nullopt  // asking all nodes is slow
                         : subscriber_of_other_type();
  if (now - driven_since_ < kPatience) {
    return;
  }
  const std::string misfit = publisher_.misfit();
  if (!misfit.empty() && !std::exchange(told_misfit_, true)) {
    log::warning(
        "a subscriber of '{}' gets no command: it asks for {}; '{} info -v {}' names it: give it "
        "the default quality of service",
        address_.topic, misfit, topics::topic_command(session_.dialect()), address_.topic);
  }
  if (other && !std::exchange(told_type_, true)) {
    log::warning("{} subscribes to '{}' as {} and gets no command of type {}; {}, or another topic",
                 other->node.empty() ? "a node" : "node " + other->node, address_.topic,
                 other->type, address_.message_type,
                 topics::remedy_for_type(other->type, address_.message_type));
  }
  const bool has_reason =
      told_misfit_ || told_type_ ||
      session_.has_warned_of_unreachable_node(session_.whole_topic(address_.topic));
  if (!subscribed && !has_reason && !std::exchange(told_none_, true)) {
    log::warning(
        "no subscriber of {} on topic '{}'; the robot will not move. '{} info {}' shows "
        "subscribers "
        "and their types",
        address_.message_type, address_.topic, topics::topic_command(session_.dialect()),
        address_.topic);
  }
}

std::optional<topics::Partner> CommandEndpoint::subscriber_of_other_type() const {
  for (const topics::Partner& partner : session_.subscribers(address_.topic)) {
    if (partner.type != type_) {
      return partner;
    }
  }
  return std::nullopt;
}

void CommandEndpoint::leave_to_guard_if_dead() {
  if (guard_ && !session_.alive()) {
    guard_->abandon();
  }
}

}  // namespace spikeloop::ros_command
