// What the command line of spikeloop-robot says.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "spikeloop/core/time.hpp"
#include "spikeloop/robot/stepped_robot.hpp"

namespace spikeloop::robot {

struct RunOptions {
  vehicle::Options vehicle;
  std::optional<vehicle::ModelOptions> model{};  ///< in the vehicle's place
  double model_rate_hz = 100;                    ///< of its joint states and sensors
  std::optional<pictures::CameraOptions> camera{};
  SpectatorOptions spectators{};
  double duration_s = 0;  ///< 0: until stopped
  double real_time_factor = 1;
  double clock_rate_hz = 100;
  bool step = false;  ///< an experiment decides when it moves
  std::string out;    ///< directory for trajectory.csv and world.json; empty: none
  std::string scan_topic = "scan";
  std::string odometry_topic = "odom";
  std::string clock_topic = "/clock";
  std::string command_topic;  ///< empty: as robot::CommandTopic names it
  std::string topic_prefix;   ///< empty: the node's namespace
  std::string node_name = "spikeloop_robot";
  int ros = 1;  ///< its version
  double master_timeout_s = 10;
  OnWriteFailure on_write_failure = OnWriteFailure::stop;
  std::shared_ptr<WriteFailures> failures = std::make_shared<WriteFailures>();

  /// A topic's name: one that begins with '/' stands as it is, others follow the prefix.
  std::string topic(const std::string& name) const;
  /// To be called every tick, as WriteFailures::check().
  void check_files() const { failures->check(on_write_failure); }
  /// The same of one of the robot's sensors, "scan" and "odom" under their own names.
  std::string sensor_topic(const std::string& name) const;
  RobotOptions robot() const {
    const auto dialect = ros == 2 ? messages::Dialect::ros2 : messages::Dialect::ros1;
    return {.vehicle = vehicle,
            .model = model,
            .sensors = {.dialect = dialect, .camera = camera, .rate_hz = model_rate_hz},
            .spectators = spectators,
            .folder = out,
            .failures = failures.get()};
  }
  std::string command_topic_of(const CommandTopic& robot) const {
    return topic(command_topic.empty() ? robot.name() : command_topic);
  }
};

/// Nothing to run when help or version was asked for or the command line is wrong; then
/// `exit_code` says how to end.
std::optional<RunOptions> parse_options(int argc, char** argv, int& exit_code);

}  // namespace spikeloop::robot
