// Topics of ROS 1 for an experiment in one process.
#pragma once

#include "spikeloop/fused/transport.hpp"
#include "spikeloop/ros1/session.hpp"

namespace spikeloop {

class Ros1Transport : public fused::Transport {
 public:
  /// @throws TransportError without a ROS master.
  explicit Ros1Transport(const experiment::Experiment& experiment);

  std::unique_ptr<Source> sensor(const fused::SensorSpec& spec) override;
  std::unique_ptr<fused::CommandEnd> command(const fused::CommandSpec& spec) override;

 private:
  const experiment::Experiment& experiment_;
  ros1::Session session_;
};

}  // namespace spikeloop
