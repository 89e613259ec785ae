// The robot in MuJoCo: with its messages, when they are due.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "spikeloop/pictures/film.hpp"
#include "spikeloop/robot/command_topic.hpp"
#include "spikeloop/robot/files.hpp"
#include "spikeloop/robot/messages.hpp"
#include "spikeloop/robot/robot.hpp"
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
  /// Of the vehicle: an episode ends in a goal of the world, off its lanes, or at a collision. It
  /// has two more topics, `reward` and `episode`, of std_msgs/Float64MultiArray, every 20 ms.
  std::optional<EpisodeSettings> episodes{};
  /// Where the vehicle's trajectory.csv, world.json and episodes.csv are written; empty: nowhere.
  std::string folder{};
  WriteFailures* failures = nullptr;  ///< see RowFile
};

class SteppedRobot : public Robot {
 public:
  /// @throws Error as vehicle::Vehicle, vehicle::Simulation, Sensors, Spectators; FileError when
  /// the folder cannot be written.
  explicit SteppedRobot(const RobotOptions& options);

  const std::vector<SensorTopic>& topics() const override { return sensors_.topics(); }
  /// As Sensors::begin_stamps; of everything that is published.
  void begin_stamps(TimeNs stamp) { sensors_.begin_stamps(stamp); }
  const CommandTopic& command_topic() const { return command_topic_; }
  CommandDescription command_description() const override;
  void publish(TimeNs time, const Wanted& wanted, const Publish& publish) override;
  /// A command, as command_topic() reads it, that holds from now on.
  void act(std::span<const double> command) { robot_->command(command); }
  void command(std::span<const std::byte> message) override;
  void advance(TimeNs time) override;
  /// Ends the trajectory and the film. @throws FileError.
  void finish() override;
  const Episodes* episodes() const override { return episodes_ ? &*episodes_ : nullptr; }
  nlohmann::json summary() const override;

  TimeNs time() const { return robot_->time(); }
  const vehicle::Simulation& robot() const { return *robot_; }

 private:
  void write_row();
  /// An episode may end, or begin, now.
  void step_episode();

  /// The vehicle of a robot with episodes.
  vehicle::Vehicle& vehicle() { return static_cast<vehicle::Vehicle&>(*robot_); }

  std::unique_ptr<vehicle::Simulation> robot_;
  std::uint64_t seed_;
  Sensors sensors_;
  Spectators spectators_;
  std::optional<TrajectoryFile> trajectory_;
  std::optional<Episodes> episodes_;
  CommandTopic command_topic_;
  std::optional<std::vector<double>> command_;  ///< that holds from the next advance on
  std::optional<std::vector<double>> newest_;
};

}  // namespace spikeloop::robot
