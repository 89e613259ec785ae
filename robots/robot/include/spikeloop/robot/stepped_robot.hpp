// The vehicle for whoever advances it: with its messages, when they are due.
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "spikeloop/robot/files.hpp"
#include "spikeloop/robot/messages.hpp"
#include "spikeloop/vehicle/vehicle.hpp"

namespace spikeloop::robot {

/// Begins at time 0. Only what it is told decides what it does: the same calls give the same bytes.
class SteppedRobot {
 public:
  using Publish = std::function<void(std::span<const std::byte>)>;
  struct Outputs {
    Publish scan;
    Publish odometry;
  };

  /// @param folder where trajectory.csv and world.json are written; empty: nowhere
  /// @throws Error as vehicle::Vehicle; FileError when the folder cannot be written.
  /// @param ros what its messages are
  SteppedRobot(const vehicle::Options& options, const std::string& folder, messages::Dialect ros);

  /// The messages that have become due since the last call, scans as often as the world says and
  /// odometry every 20 ms, each at most once: as things are now, at `time`.
  void publish(TimeNs time, const Outputs& outputs);
  /// A geometry_msgs/Twist: the newest one holds when the next advance is over.
  void command(std::span<const std::byte> twist) { command_ = twist_.read(twist); }
  /// Advances to `time` on the command before; from there on the newest one holds.
  void advance(TimeNs time);
  /// Ends the trajectory.
  void finish();

  TimeNs time() const { return vehicle_.time(); }
  vehicle::Statistics statistics() const { return vehicle_.statistics(); }

 private:
  vehicle::Vehicle vehicle_;
  std::optional<TrajectoryFile> trajectory_;
  ScanMessage scan_;
  OdometryMessage odometry_;
  TwistReader twist_;
  std::optional<Command> command_;
  TimeNs scan_period_ = 0;
  TimeNs next_scan_ = 0;
  TimeNs next_odometry_ = 0;
};

}  // namespace spikeloop::robot
