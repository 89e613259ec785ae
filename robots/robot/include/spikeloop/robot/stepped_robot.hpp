// The robot for whoever advances it: with its messages, when they are due.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "spikeloop/pictures/film.hpp"
#include "spikeloop/robot/command_topic.hpp"
#include "spikeloop/robot/files.hpp"
#include "spikeloop/robot/messages.hpp"
#include "spikeloop/robot/sensors.hpp"
#include "spikeloop/robot/spectators.hpp"
#include "spikeloop/vehicle/vehicle.hpp"

namespace spikeloop::robot {

struct RobotOptions {
  vehicle::Options vehicle{};
  /// A robot in the vehicle's place.
  std::optional<vehicle::ModelOptions> model{};
  SensorOptions sensors{};
  SpectatorOptions spectators{};
  /// Where the vehicle's trajectory.csv and world.json are written; empty: nowhere.
  std::string folder{};
};

/// @throws Error as vehicle::Vehicle and vehicle::Simulation.
std::unique_ptr<vehicle::Simulation> make_robot(const vehicle::Options& vehicle,
                                                const std::optional<vehicle::ModelOptions>& model);

/// Begins at time 0. Only what it is told decides what it does: the same calls give the same bytes.
class SteppedRobot {
 public:
  /// Whether somebody wants the messages of a topic; the others are not made.
  using Wanted = std::function<bool(std::size_t topic)>;
  using Publish = std::function<void(std::size_t topic, std::span<const std::byte> message)>;

  /// @throws Error as make_robot, Sensors, Spectators; FileError when the folder cannot be
  /// written.
  explicit SteppedRobot(const RobotOptions& options);

  const std::vector<SensorTopic>& topics() const { return sensors_.topics(); }
  const CommandTopic& command_topic() const { return command_topic_; }
  /// The messages that have become due since the last call, each topic's at most once: as things
  /// are now, at `time`.
  void publish(TimeNs time, const Wanted& wanted, const Publish& publish);
  /// A command, as command_topic() reads it, that holds from now on.
  void act(std::span<const double> command) { robot_->command(command); }
  /// A message of command_topic(): the newest one holds when the next advance is over.
  void command(std::span<const std::byte> message) { command_ = command_topic_.read(message); }
  /// Advances to `time` on the command before; from there on the newest one holds.
  void advance(TimeNs time);
  /// Ends the trajectory and the film. @throws FileError.
  void finish();

  TimeNs time() const { return robot_->time(); }
  const vehicle::Simulation& robot() const { return *robot_; }

 private:
  void write_row();

  std::unique_ptr<vehicle::Simulation> robot_;
  Sensors sensors_;
  Spectators spectators_;
  std::optional<TrajectoryFile> trajectory_;
  CommandTopic command_topic_;
  std::optional<std::vector<double>> command_;
};

}  // namespace spikeloop::robot
