// The robot in this process, stepped by the loop.
#pragma once

#include <memory>
#include <vector>

#include "spikeloop/fused/transport.hpp"
#include "spikeloop/robot/robot.hpp"
#include "spikeloop/topics/memory_session.hpp"

namespace spikeloop::fused {

class MemoryTransport : public Transport {
 public:
  /// @param robot null: nothing is at the other end
  explicit MemoryTransport(std::unique_ptr<robot::Robot> robot);

  topics::Session& session(const experiment::Node& /*node*/) override { return session_; }
  /// Publishes what has become due since the last call.
  void begin(TimeNs time) override;
  /// The robot advances to `time` on the command before; then the newest one holds.
  void end(TimeNs time) override;
  const robot::Episodes* episodes() const override { return robot_ ? robot_->episodes() : nullptr; }
  void finish() override;
  nlohmann::json summary() const override;

 private:
  topics::MemorySession session_;
  std::unique_ptr<robot::Robot> robot_;
  std::vector<std::unique_ptr<topics::RawPublisher>> publishers_;  ///< of its topics
  std::unique_ptr<topics::RawSubscriber> commands_;
};

}  // namespace spikeloop::fused
