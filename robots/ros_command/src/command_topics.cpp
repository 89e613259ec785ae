#include "command_topics.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <exception>
#include <thread>

#include "spikeloop/core/log.hpp"
#include "spikeloop/core/pacer.hpp"
#include "spikeloop/messages/catalog.hpp"

namespace spikeloop::ros_command {
namespace {

using std::chrono::milliseconds;

/// Longest wait for a connection to programs that can stop the robot.
constexpr milliseconds kLongestWait{2'000};

/// Unlimited: a press must not be overwritten by the release that follows at once, and ROS 2 sends
/// it again if the network loses it.
constexpr std::uint32_t kEveryPress = 0;

/// Waits until all publishers of the topic are connected: otherwise a button that is pressed as
/// soon as the robot drives would have no effect.
void wait_for_publishers(const topics::Session& session, const std::string& topic) {
  const std::string whole = session.whole_topic(topic);
  const auto end = std::chrono::steady_clock::now() + kLongestWait;
  while (std::chrono::steady_clock::now() < end && session.has_publishers(whole) &&
         !session.publishers_are_connected(whole)) {
    std::this_thread::sleep_for(milliseconds(5));
  }
}

}  // namespace

CommandTopics::CommandTopics(topics::Session& session, const std::string& message_type,
                             const std::vector<std::string>& fields,
                             const command::CommandSettings& settings, command::CommandSink& sink)
    : settings_(settings), sink_(sink) {
  const auto reader = [&](const std::string& type, const std::string& field) {
    return messages::FieldReader(messages::Catalog::for_type(session.dialect(), type), type, field);
  };
  const command::EmergencyStop& stop = settings_.emergency_stop;
  if (!stop.topic.empty()) {
    emergency_fields_.push_back(reader(stop.message_type, stop.field));
    emergency_ = subscribe(session, stop.topic, stop.message_type, kEveryPress,
                           &CommandTopics::take_emergency);
    sink_.watch_publishers([this] { return emergency_->has_publishers(); });
  }
  if (!settings_.manual.topic.empty()) {
    for (const std::string& field : fields) {
      manual_fields_.push_back(reader(message_type, field));
    }
    manual_ =
        subscribe(session, settings_.manual.topic, message_type, 1, &CommandTopics::take_manual);
  }
  if (emergency_) {
    wait_for_publishers(session, stop.topic);
  }
}

CommandTopics::~CommandTopics() {
  sink_.watch_publishers({});
}

std::unique_ptr<topics::RawSubscriber> CommandTopics::subscribe(
    topics::Session& session, const std::string& topic, const std::string& message_type,
    std::uint32_t queue, void (CommandTopics::*take)(std::span<const std::byte>)) {
  return session.subscriber({.topic = topic,
                             .message_type = message_type,
                             .queue = queue,
                             .latched = queue == kEveryPress,
                             .take = [this, take](auto message) { (this->*take)(message); },
                             .refuse = [this](const auto& other) { other_types_.add(other); }});
}

void CommandTopics::report_other_types() {
  while (const auto other = other_types_.take()) {
    log::warning("{}; its messages are ignored", other->text);
  }
}

void CommandTopics::take_emergency(std::span<const std::byte> message) {
  bool stop = true;  // a message that cannot be read stops the robot, too
  try {
    std::vector<double> values;
    emergency_fields_.front().read(message, values);
    stop = values.empty() || values.front() != 0;
  } catch (const std::exception& error) {
    log::warning("topic '{}': {}; the robot is stopped", settings_.emergency_stop.topic,
                 error.what());
  }
  sink_.emergency(stop);
}

void CommandTopics::take_manual(std::span<const std::byte> message) {
  std::vector<double> values;
  try {
    for (const messages::FieldReader& field : manual_fields_) {
      field.read(message, values);
    }
  } catch (const std::exception& error) {
    log::warning("topic '{}': {}; the message is left out", settings_.manual.topic, error.what());
    return;
  }
  if (values.size() != settings_.width()) {
    if (!warned_.exchange(true)) {
      log::warning("topic '{}': a message with {} values, where a command has {}, is left out",
                   settings_.manual.topic, values.size(), settings_.width());
    }
    return;
  }
  const auto finite = [](double value) { return std::isfinite(value); };
  if (!std::ranges::all_of(values, finite) && !warned_of_not_finite_.exchange(true)) {
    log::warning("topic '{}': a manual command that is not a finite number stops the robot",
                 settings_.manual.topic);
  }
  sink_.override_with(values);
}

}  // namespace spikeloop::ros_command
