// Connects a command to its topic and to everything that stops the robot: the watch of the sink,
// the guard, and the end of the process.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "spikeloop/command/command_sink.hpp"
#include "spikeloop/guard/link.hpp"
#include "spikeloop/ros_command/measured_positions.hpp"
#include "spikeloop/status/signals.hpp"
#include "spikeloop/status/supervision.hpp"
#include "spikeloop/topics/publisher.hpp"
#include "spikeloop/topics/session.hpp"
#include "spikeloop/topics/topic_source.hpp"

namespace spikeloop::ros_command {

class CommandTopics;
class Diagnostics;

/// On a local session the robot is stepped by the loop itself: there is no guard, and the end of
/// the process ends the robot, too.
class CommandEndpoint : private command::CommandSink::Transport {
 public:
  /// Advertises the topic in this process and in the guard, so that both are connected to
  /// subscribers before the robot is driven. Until the guard is connected to a subscriber, for at
  /// most 3 s, ticks send nothing.
  /// @throws ConfigurationError as topics::Publisher.
  CommandEndpoint(topics::Session& session, const command::CommandSettings& settings,
                  topics::Keep keep = {});
  ~CommandEndpoint() override;
  CommandEndpoint(const CommandEndpoint&) = delete;
  CommandEndpoint& operator=(const CommandEndpoint&) = delete;

  /// Sink for a graph. Stop it by stop() of this class.
  command::CommandSink& sink() { return sink_; }
  /// Sends the stop command as the last message.
  void stop(command::StopReason reason);
  /// Summary of the CommandSink. Key `stood_at_end`: reason of a stop for lack of data before the
  /// end.
  nlohmann::json summary() const;
  /// Condition of the CommandSink, or a warning if the topic has no subscriber. Thread-safe.
  command::Condition condition() const;
  const std::string& node() const { return settings_.process; }

  /// True if the robot and the guard are connected. Call in the loop's thread.
  bool has_subscribers() { return publisher_.raw().has_subscribers() && may_begin(); }
  /// As topics::RawPublisher::deliver.
  bool deliver() const { return publisher_.raw().deliver(); }
  /// Number of messages that were sent, stop commands included.
  std::uint64_t sent() const { return count_; }
  /// Null if a stop holds no measured position.
  const MeasuredPositions* positions() const { return positions_.get(); }

 private:
  void publish(std::span<const double> values) override;
  void finish() override;
  bool begin_tick(TimeNs end) override;
  void end_tick() override;
  TimeNs beat(TimeNs now) override;
  std::optional<command::StopReason> lost_supervision(TimeNs now) override;

  void keep_sent();
  void leave_to_guard_if_dead();
  bool may_begin();
  bool awaits_position();
  void check_subscribers();

  topics::Session& session_;
  const command::CommandSettings settings_;
  const std::string topic_;  ///< name after remapping
  TimeNs driven_since_ = 0;  ///< wall time of the first command; 0: none yet
  TimeNs checked_at_ = 0;    ///< wall time of the last check of the subscribers
  bool warned_of_misfit_ = false;
  bool warned_of_type_ = false;
  bool warned_of_no_subscriber_ = false;
  bool warned_of_no_position_ = false;
  TimeNs first_tick_ = 0;  ///< wall time; 0: none yet
  TimeNs met_at_ = 0;      ///< wall time of the first check that found a subscriber; 0: none yet
  std::atomic<bool> waits_for_guard_;
  topics::Publisher publisher_;
  topics::Keep keep_;
  TimeNs ended_ = 0;  ///< end of the newest tick
  std::mutex sending_;
  std::vector<std::vector<std::byte>> sent_;  ///< messages since the last tick, for `keep_`
  std::atomic<std::uint64_t> count_{0};
  std::string stood_at_end_;
  std::unique_ptr<status::SupervisedRobot> supervised_;  ///< null on a local session
  std::unique_ptr<guard::Link> guard_;                   ///< null on a local session
  std::unique_ptr<Diagnostics> diagnostics_;             ///< null for a robot that is stepped
  command::CommandSink sink_;
  std::unique_ptr<CommandTopics> topics_;         ///< its callbacks use sink_
  std::unique_ptr<MeasuredPositions> positions_;  ///< null if a stop holds no measured position
  std::unique_ptr<status::TerminationHook> on_termination_;
  std::unique_ptr<status::StopHook> on_stop_;  ///< null for a robot that is stepped
};

}  // namespace spikeloop::ros_command
