// The robot in this process, stepped by the loop.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "memory_topics.hpp"
#include "spikeloop/fused/transport.hpp"
#include "spikeloop/robot/stepped_robot.hpp"

namespace spikeloop::fused {

/// Topics: those of robot::Sensors, and /cmd_vel.
class MemoryTransport : public Transport {
 public:
  /// @param robot none: nothing is at the other end
  /// @throws Error as vehicle::Vehicle; FileError when the folder cannot be written.
  MemoryTransport(const std::optional<experiment::Robot>& robot, const std::string& folder,
                  const robot::SpectatorOptions& spectators = {});

  std::unique_ptr<Source> sensor(const SensorSpec& spec) override {
    return make_memory_sensor(topics_, spec);
  }
  std::unique_ptr<CommandEnd> command(const CommandSpec& spec) override {
    return make_memory_command(topics_, spec);
  }
  /// Publishes what has become due since the last call.
  void begin(TimeNs time) override;
  /// The robot advances to `time` on the command before; then the newest one holds.
  void end(TimeNs time) override;
  void finish() override;
  nlohmann::json summary() const override;

 private:
  MemoryTopics topics_;
  std::optional<robot::SteppedRobot> robot_;
  std::vector<std::string> names_;  // of its topics
};

}  // namespace spikeloop::fused
