// The robot's end of ROS 1: three topics out, one in.
#pragma once

#include <atomic>
#include <memory>
#include <optional>

#include "options.hpp"
#include "spikeloop/robot/messages.hpp"
#include "spikeloop/ros1/arguments.hpp"

namespace spikeloop::robot {

class RosLink {
 public:
  /// Waits for the master, then advertises and subscribes; does neither once `stop` is true.
  /// @throws TransportError when no master answers in time; ConfigurationError when
  /// ROS_MASTER_URI, a topic or the node's name is malformed.
  RosLink(const RunOptions& options, const ros1::RosArguments& arguments,
          const std::atomic<bool>& stop);
  ~RosLink();

  void publish(const vehicle::LaserScan& scan);
  void publish(const vehicle::Odometry& odometry);
  void publish_clock(TimeNs time);

  /// The newest command since the last call.
  std::optional<Command> take_command();
  std::uint64_t commands() const;  ///< that have come
  /// False when ROS has shut the node down, as it does when another one takes its name.
  bool alive() const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace spikeloop::robot
