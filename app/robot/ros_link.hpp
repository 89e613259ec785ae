// The robot's end of ROS: its sensors and the clock out, commands in.
#pragma once

#include <atomic>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "options.hpp"
#include "spikeloop/robot/command_topic.hpp"
#include "spikeloop/robot/messages.hpp"
#include "spikeloop/robot/sensors.hpp"
#include "spikeloop/topics/session.hpp"

namespace spikeloop::robot {

/// Waits for what ROS needs; null when `stop` became true before it was there.
/// @throws TransportError when no master answers in time; ConfigurationError when ROS_MASTER_URI or
/// the node's name is malformed.
std::unique_ptr<topics::Session> open_session(const RunOptions& options,
                                              const topics::RosArguments& arguments,
                                              const std::atomic<bool>& stop);

class RosLink {
 public:
  /// Advertises `sensors`, and the clock; subscribes to commands.
  /// @param command of the robot; must outlive this
  /// @throws ConfigurationError when a topic is malformed.
  RosLink(const RunOptions& options, topics::Session& session,
          const std::vector<SensorTopic>& sensors, const CommandTopic& command);
  ~RosLink();

  /// Whether somebody listens to a sensor, or may later.
  bool wanted(std::size_t sensor) const;
  void publish(std::size_t sensor, std::span<const std::byte> message);
  void publish_clock(TimeNs time);

  /// The newest command since the last call, for Simulation::command().
  std::optional<std::vector<double>> take_command();
  std::uint64_t commands() const;  ///< that have come
  /// False when ROS has shut the node down, as it does when another one takes its name.
  bool alive() const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace spikeloop::robot
