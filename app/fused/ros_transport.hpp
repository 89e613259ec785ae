// Topics of ROS for an experiment in one process.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "odometry_log.hpp"
#include "spikeloop/fused/transport.hpp"
#include "spikeloop/ros_command/ros_command.hpp"
#include "spikeloop/topics/session.hpp"
#include "stepping_link.hpp"
#include "waiting.hpp"

namespace spikeloop {

class RosTransport : public fused::Transport {
 public:
  /// @param ros_arguments as read_ros_arguments() takes them
  /// @param folder where the path of a robot that is not ours is written; empty: nowhere
  /// @throws TransportError without a ROS master.
  RosTransport(const experiment::Experiment& experiment, const std::string& ros_arguments,
               const std::string& folder, const LoopSurroundings& surroundings);

  std::unique_ptr<Source> sensor(const fused::SensorSpec& spec) override;
  std::unique_ptr<fused::CommandEnd> command(const fused::CommandSpec& spec) override;
  std::unique_ptr<Pacer> clock() override;
  void begin(TimeNs time) override;
  void end(TimeNs time) override;
  void finish() override;
  nlohmann::json summary() const override;

 private:
  std::unique_ptr<Source> signal_sensor(const fused::SensorSpec& spec);
  std::unique_ptr<Source> event_sensor(const fused::SensorSpec& spec);
  template <typename Settings>
  void add_surroundings(const fused::SensorSpec& spec, Settings& settings);
  template <typename Sensor>
  void add_to_robot(const std::string& topic, const Sensor& sensor);
  command::CommandSettings command_settings(const fused::CommandSpec& spec) const;

  const experiment::Experiment& experiment_;
  std::unique_ptr<topics::Session> session_;
  Waiting waiting_;
  std::optional<OdometryLog> odometry_;
  std::optional<SteppingLink> robot_;               ///< with sync: lockstep
  std::vector<ros_command::RosCommand*> commands_;  ///< the loop's, and alive as long as it runs
};

}  // namespace spikeloop
