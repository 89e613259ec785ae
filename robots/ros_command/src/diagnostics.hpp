// Condition of a robot for monitors of ROS.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "spikeloop/command/command_sink.hpp"
#include "spikeloop/core/node.hpp"
#include "spikeloop/messages/message_writer.hpp"
#include "spikeloop/topics/session.hpp"

namespace spikeloop::ros_command {

/// Publishes the condition of the robot on /diagnostics (diagnostic_msgs/DiagnosticArray, REP 107):
/// every second, and when it changes.
class Diagnostics {
 public:
  /// @param topic topic of the commands
  Diagnostics(topics::Session& session, const std::string& topic);

  /// Call in a single thread. Returns the wall time of the next call.
  TimeNs publish(TimeNs now, const command::Condition& condition, const command::CommandSink& sink);

 private:
  void write(const std::vector<Counter>& counters);

  std::string name_;
  messages::Dialect dialect_;
  std::unique_ptr<topics::RawPublisher> publisher_;
  std::optional<messages::MessageWriter> writer_;  ///< created with the first counters
  std::vector<std::byte> message_;
  command::Condition told_{};
  TimeNs sent_ = 0;  ///< wall time of the newest message
};

}  // namespace spikeloop::ros_command
