// An environment of reinforcement learning in a robot's place. It advances in steps: at the end of
// each it takes the newest action, and publishes.
//
// | topic              | carries                    | values                                     |
// |--------------------|----------------------------|--------------------------------------------|
// | observation        | std_msgs/Float64MultiArray | in the units of the environment            |
// | scaled_observation | std_msgs/Float64MultiArray | each from -1 to 1 over its range, if finite |
// | reward             | std_msgs/Float64MultiArray | 1                                          |
// | episode            | std_msgs/Float64MultiArray | Episodes::state                            |
// | action             | std_msgs/Float64MultiArray | 1, for the environment                     |
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "spikeloop/environments/environment.hpp"
#include "spikeloop/messages/dialect.hpp"
#include "spikeloop/robot/messages.hpp"
#include "spikeloop/robot/robot.hpp"

namespace spikeloop::robot {

struct EnvironmentOptions {
  std::string name;
  environments::Options environment{};
  std::uint64_t seed = 1;
  std::optional<TimeNs> step{};  ///< none: the environment's own
  /// What every number of an observation is in a pause; none: that of the last step.
  std::optional<double> pause_observation{};
  /// A time limit that is not given is that of the environment.
  EpisodeSettings episodes{};
  messages::Dialect dialect = messages::Dialect::ros1;
  std::string folder{};               ///< folder of episodes.csv. Empty: no file
  WriteFailures* failures = nullptr;  ///< see RowFile
};

class EnvironmentRobot : public Robot {
 public:
  /// @throws Error as environments::make and Episodes.
  explicit EnvironmentRobot(const EnvironmentOptions& options);

  const std::vector<SensorTopic>& topics() const override { return topics_; }
  CommandDescription command_description() const override;
  void publish(TimeNs time, const Wanted& wanted, const Publish& publish) override;
  void command(std::span<const std::byte> message) override;
  /// @throws Error for an action that the environment does not have.
  void advance(TimeNs time) override;
  const Episodes* episodes() const override { return &episodes_; }
  void finish() override { episodes_.finish(); }
  nlohmann::json summary() const override;

  TimeNs step() const { return step_; }

 private:
  void begin(TimeNs time);
  std::vector<double> observation() const;
  std::vector<double> scaled(std::vector<double> observation) const;
  std::span<const std::byte> write(std::size_t topic);

  std::unique_ptr<environments::Environment> environment_;
  std::uint64_t seed_;
  TimeNs step_;
  std::optional<double> pause_observation_;
  Episodes episodes_;
  std::vector<SensorTopic> topics_;
  NumbersMessage message_;
  messages::FieldReader action_reader_;
  TimeNs now_ = 0;
  TimeNs published_ = -1;
  std::optional<double> action_;  ///< that holds
  std::optional<double> newest_;
};

}  // namespace spikeloop::robot
