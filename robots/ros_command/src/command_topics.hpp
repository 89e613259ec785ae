// Topics of operator input: the emergency stop and manual commands.
#pragma once

#include <atomic>
#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "spikeloop/command/command_sink.hpp"
#include "spikeloop/messages/field_path.hpp"
#include "spikeloop/topics/other_types.hpp"
#include "spikeloop/topics/session.hpp"

namespace spikeloop::ros_command {

/// Passes messages to the sink in the session's thread as soon as they arrive.
class CommandTopics {
 public:
  /// @param message_type type of the commands and of manual commands
  /// @param fields paths of the commands: one per component, or a single one for a whole array
  /// @throws ConfigurationError: unknown type or field, an impossible topic.
  CommandTopics(topics::Session& session, const std::string& message_type,
                const std::vector<std::string>& fields, const command::CommandSettings& settings,
                command::CommandSink& sink);
  ~CommandTopics();
  CommandTopics(const CommandTopics&) = delete;
  CommandTopics& operator=(const CommandTopics&) = delete;

  /// Warns once per topic that carries another type. Call in the loop's thread.
  void report_other_types();

 private:
  void take_emergency(std::span<const std::byte> message);
  void take_manual(std::span<const std::byte> message);
  std::unique_ptr<topics::RawSubscriber> subscribe(
      topics::Session& session, const std::string& topic, const std::string& message_type,
      std::uint32_t queue, void (CommandTopics::*take)(std::span<const std::byte>));

  command::CommandSettings settings_;
  command::CommandSink& sink_;
  std::vector<messages::FieldReader> emergency_fields_;
  std::vector<messages::FieldReader> manual_fields_;
  topics::OtherTypes other_types_;
  std::atomic<bool> warned_{false};
  std::atomic<bool> warned_of_not_finite_{false};
  std::unique_ptr<topics::RawSubscriber> emergency_;
  std::unique_ptr<topics::RawSubscriber> manual_;
};

}  // namespace spikeloop::ros_command
