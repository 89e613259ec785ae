// Input other than the network's commands: the emergency stop, STOP of the live view, manual
// commands, and lost supervision.
#pragma once

#include <functional>
#include <mutex>
#include <optional>
#include <span>
#include <vector>

#include "spikeloop/command/command_channel.hpp"

namespace spikeloop::command {

/// Rule of the emergency stop. A pure function of messages and times.
class EmergencyRule {
 public:
  explicit EmergencyRule(const EmergencyStop& settings) : settings_(settings) {}

  /// Takes a message.
  void take(bool stop, TimeNs now);
  /// Reason to stop; nullopt if the robot may be driven.
  std::optional<StopReason> verdict(bool has_publishers, TimeNs now) const;

 private:
  EmergencyStop settings_;
  bool stop_ = false;
  std::optional<TimeNs> heard_;
};

/// Passes operator input to a command channel. Thread-safe.
class OperatorInput {
 public:
  OperatorInput(const EmergencyStop& settings, CommandChannel& channel)
      : rule_(settings), channel_(channel) {}

  /// Sets the function that returns true if the topic of the emergency stop has a publisher. The
  /// previous function is not called after this call has returned.
  void watch_publishers(std::function<bool()> has_publishers);
  // Input takes effect when apply() is called.

  /// Takes a message of the emergency stop.
  void emergency(bool stop, TimeNs wall);
  /// Sets STOP of the live view. Messages of the emergency stop do not release it.
  void press_stop(bool pressed);
  /// Sets the reason to stop while the robot is not supervised or guarded; nullopt if it may be
  /// driven.
  void set_lost_supervision(std::optional<StopReason> reason);
  /// Takes a manual command.
  void override_with(std::span<const double> values);
  /// Applies the input to the channel.
  /// @param wall wall time, for the time-out of the emergency stop
  /// @param now time of the channel's clock
  void apply(TimeNs wall, TimeNs now);

 private:
  std::mutex asking_;  ///< held while has_publishers_ runs, which may wait for other threads
  std::function<bool()> has_publishers_;
  std::mutex mutex_;
  EmergencyRule rule_;
  bool stop_pressed_ = false;
  std::optional<StopReason> lost_supervision_;
  CommandChannel& channel_;
  std::optional<std::vector<double>> manual_;  ///< newest command that is not applied yet
};

}  // namespace spikeloop::command
