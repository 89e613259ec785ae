// Topic as a source: the channels of the newest message, read when it arrives.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "spikeloop/messages/sensor_rule.hpp"
#include "spikeloop/topics/session.hpp"
#include "spikeloop/topics/topic_source.hpp"

namespace spikeloop::topics {

struct SensorSettings {
  std::string node{};  ///< name for warnings; empty in a .music file
  std::string topic;
  std::string message_type;     ///< "sensor_msgs/LaserScan"
  messages::SensorRule rule{};  ///< see messages::SensorConversion; usually empty
  std::uint32_t width = 0;
  bool strict = false;
  /// Value of every channel before its first valid value. nullopt: no value.
  std::optional<double> initial{};
  /// True if `data_stamp` is the simulated time of the tick that first uses a message.
  bool simulated_stamp = false;
  std::uint32_t queue = 10;         ///< messages that may wait; 0: unlimited
  std::function<void()> arrived{};  ///< called in the session's thread after every message
  Keep keep{};                      ///< called for every message since the last tick
};

/// Ports: `out` [width]; `data_stamp` [1], the monotonic time in seconds at which the newest
/// message of this tick arrived, without a value before the first message.
///
/// Counters: messages, cropped, short_messages, invalid_readings, without_reading, malformed,
/// wrong_type, and over ROS 2 lost (RawSubscriber::lost()).
class Sensor : public TopicSource {
 public:
  /// Subscribes. @throws ConfigurationError as messages::SensorConversion, and for an invalid
  /// topic.
  Sensor(Session& session, const SensorSettings& settings);
  ~Sensor() override;

  /// Throws the exceptions of the constructor, without a session.
  static void check(messages::Dialect ros, const SensorSettings& settings);

  std::vector<EndpointPort> ports() const override;
  /// @throws TransportError if the topic carries only messages of another type or version, or if
  /// the session's node has been shut down; ConfigurationError if `strict` and a message does not
  /// fit the port.
  void receive(const Step& step) override;
  std::vector<Counter> counters() const override;

 private:
  const TopicReader& reader() const override;

  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace spikeloop::topics
