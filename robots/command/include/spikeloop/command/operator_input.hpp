// Input other than the network's commands: the emergency stop, STOP of the live view, manual
// commands, and whether the job is supervised.
#pragma once

#include <functional>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "spikeloop/command/command_channel.hpp"
#include "spikeloop/command/emergency_stop.hpp"

namespace spikeloop::command {

/// Commands by hand, in messages of the command's own type.
struct Override {
  std::string topic{};  ///< empty: there is none
  TimeNs timeout = 500'000'000;

  bool operator==(const Override&) const = default;
};

/// Hands them on to a command channel. Safe to use from any thread.
class OperatorInput {
 public:
  OperatorInput(const EmergencyStop& settings, CommandChannel& channel)
      : rule_(settings), channel_(channel) {}

  /// Whether the emergency stop's topic has a publisher. What was given before is not called any
  /// more when it returns; empty: nobody knows.
  void watch_publishers(std::function<bool()> has_publishers);
  /// A message has come; it counts when apply() is called.
  void emergency(bool stop, TimeNs wall);
  /// STOP of the live view, which no message releases; the same.
  void press_stop(bool pressed);
  /// Reason to stop while nobody supervises or guards the robot; nullopt: it may be driven. Takes
  /// effect when apply() is called.
  void set_lost_supervision(std::optional<StopReason> reason);
  void override_with(std::span<const double> values);
  /// @param wall by which the emergency stop's timeout is judged
  /// @param now the channel's time
  void apply(TimeNs wall, TimeNs now);

 private:
  std::mutex asking_;  ///< held while has_publishers_ runs, which may wait for others
  std::function<bool()> has_publishers_;
  std::mutex mutex_;
  EmergencyRule rule_;
  bool stop_pressed_ = false;
  std::optional<StopReason> lost_supervision_;
  CommandChannel& channel_;
  std::optional<std::vector<double>> manual_;  ///< the newest that has not counted yet
};

}  // namespace spikeloop::command
