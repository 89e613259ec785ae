// The emergency stop: what it is told, and whether the robot may be driven. Pure functions.
#pragma once

#include <optional>
#include <string>

#include "spikeloop/command/stop_reason.hpp"
#include "spikeloop/core/time.hpp"

namespace spikeloop::command {

struct EmergencyStop {
  std::string topic{};  ///< empty: there is none
  std::string message_type = "std_msgs/Bool";
  std::string field = "data";  ///< path; anything but 0 stops
  bool latched = false;        ///< once stopped, the robot stands until the run is over
  bool required = false;       ///< the robot stands while the topic has no publisher
  TimeNs timeout = 0;          ///< wall time without a message that stops it; 0: any

  bool operator==(const EmergencyStop&) const = default;
};

class EmergencyRule {
 public:
  explicit EmergencyRule(const EmergencyStop& settings) : settings_(settings) {}

  /// A message has come.
  void take(bool stop, TimeNs now);
  /// Why the robot has to stand; nothing when it may be driven.
  std::optional<StopReason> verdict(bool has_publishers, TimeNs now) const;

 private:
  EmergencyStop settings_;
  bool stop_ = false;
  std::optional<TimeNs> heard_;
};

}  // namespace spikeloop::command
