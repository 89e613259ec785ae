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

/// A status on /diagnostics (diagnostic_msgs/DiagnosticArray), as REP 107 has it: every second, and
/// when it changes.
class Diagnostics {
 public:
  /// @param topic of the commands
  Diagnostics(topics::Session& session, const std::string& topic);

  /// To be called by one thread. Returns the wall time of the next call.
  TimeNs publish(TimeNs now, const command::Condition& condition, const command::CommandSink& sink);

 private:
  void write(const std::vector<Counter>& counters);

  std::string name_;
  messages::Dialect dialect_;
  std::unique_ptr<topics::RawPublisher> publisher_;
  std::optional<messages::MessageWriter> writer_;  ///< made when the counters are known
  std::vector<std::byte> message_;
  command::Condition told_{};
  TimeNs sent_ = 0;  ///< wall time
};

}  // namespace spikeloop::ros_command
