// The robot in this process, stepped by the loop.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "spikeloop/fused/transport.hpp"
#include "spikeloop/robot/stepped_robot.hpp"
#include "spikeloop/topics/memory_session.hpp"

namespace spikeloop::fused {

/// Topics: those of robot::Sensors and robot::CommandTopic.
class MemoryTransport : public Transport {
 public:
  /// @param robot none: nothing is at the other end
  /// @throws Error as robot::SteppedRobot; FileError when the folder cannot be written.
  MemoryTransport(const std::optional<experiment::Robot>& robot, const std::string& folder,
                  const robot::SpectatorOptions& spectators = {});

  topics::Session& session(const experiment::Node& /*node*/) override { return session_; }
  /// Publishes what has become due since the last call.
  void begin(TimeNs time) override;
  /// The robot advances to `time` on the command before; then the newest one holds.
  void end(TimeNs time) override;
  void finish() override;
  nlohmann::json summary() const override;

 private:
  topics::MemorySession session_;
  std::optional<robot::SteppedRobot> robot_;
  std::vector<std::unique_ptr<topics::RawPublisher>> publishers_;  ///< of its topics
  std::unique_ptr<topics::RawSubscriber> commands_;
};

}  // namespace spikeloop::fused
