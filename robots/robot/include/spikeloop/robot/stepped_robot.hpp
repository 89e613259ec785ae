// The vehicle for whoever advances it: with its messages, when they are due.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "spikeloop/pictures/film.hpp"
#include "spikeloop/robot/files.hpp"
#include "spikeloop/robot/messages.hpp"
#include "spikeloop/robot/sensors.hpp"
#include "spikeloop/robot/spectators.hpp"
#include "spikeloop/vehicle/vehicle.hpp"

namespace spikeloop::robot {

struct RobotOptions {
  vehicle::Options vehicle{};
  SensorOptions sensors{};
  SpectatorOptions spectators{};
  /// Where trajectory.csv and world.json are written; empty: nowhere.
  std::string folder{};
};

/// Begins at time 0. Only what it is told decides what it does: the same calls give the same bytes.
class SteppedRobot {
 public:
  /// Whether somebody wants the messages of a topic; the others are not made.
  using Wanted = std::function<bool(std::size_t topic)>;
  using Publish = std::function<void(std::size_t topic, std::span<const std::byte> message)>;

  /// @throws Error as vehicle::Vehicle, Sensors, Spectators; FileError when the folder cannot be
  /// written.
  explicit SteppedRobot(const RobotOptions& options);

  const std::vector<SensorTopic>& topics() const { return sensors_.topics(); }
  /// The messages that have become due since the last call, each topic's at most once: as things
  /// are now, at `time`.
  void publish(TimeNs time, const Wanted& wanted, const Publish& publish);
  /// A geometry_msgs/Twist: the newest one holds when the next advance is over.
  void command(std::span<const std::byte> twist) { command_ = twist_.read(twist); }
  /// Advances to `time` on the command before; from there on the newest one holds.
  void advance(TimeNs time);
  /// Ends the trajectory and the film. @throws FileError.
  void finish();

  TimeNs time() const { return vehicle_.time(); }
  vehicle::Statistics statistics() const { return vehicle_.statistics(); }

 private:
  vehicle::Vehicle vehicle_;
  Sensors sensors_;
  Spectators spectators_;
  std::optional<TrajectoryFile> trajectory_;
  TwistReader twist_;
  std::optional<Command> command_;
};

}  // namespace spikeloop::robot
