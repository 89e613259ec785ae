// A robot for whoever advances it: topics with messages, and a topic for commands.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>
#include <vector>

#include "spikeloop/core/time.hpp"
#include "spikeloop/robot/episodes.hpp"
#include "spikeloop/robot/sensors.hpp"

namespace spikeloop::robot {

/// The topic for commands.
struct CommandDescription {
  std::string name;                 ///< "cmd_vel"
  std::string type;                 ///< "geometry_msgs/Twist"
  std::vector<std::string> fields;  ///< paths of all fields that the robot reads
};

/// Begins at time 0. The same calls give the same bytes.
class Robot {
 public:
  /// Whether somebody wants the messages of a topic; the others are not made.
  using Wanted = std::function<bool(std::size_t topic)>;
  using Publish = std::function<void(std::size_t topic, std::span<const std::byte> message)>;

  Robot() = default;
  Robot(const Robot&) = delete;
  Robot& operator=(const Robot&) = delete;
  virtual ~Robot() = default;

  virtual const std::vector<SensorTopic>& topics() const = 0;
  virtual CommandDescription command_description() const = 0;
  /// The messages that have become due since the last call, each topic's at most once: as things
  /// are now, at `time`.
  virtual void publish(TimeNs time, const Wanted& wanted, const Publish& publish) = 0;
  /// A message for the robot: the newest one holds when the next advance is over.
  virtual void command(std::span<const std::byte> message) = 0;
  /// Advances to `time` on the command before; from there on the newest one holds.
  virtual void advance(TimeNs time) = 0;
  /// Of a robot that has a task; of any other none.
  virtual const Episodes* episodes() const { return nullptr; }
  /// Ends its files. @throws FileError.
  virtual void finish() {}
  /// What it measured, for summary.json.
  virtual nlohmann::json summary() const = 0;
};

}  // namespace spikeloop::robot
