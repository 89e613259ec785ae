// A topic as a source: the newest message's channels, taken the moment it arrives.
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
  std::string node{};  ///< its name in an experiment, for warnings; empty in a .music file
  std::string topic;
  std::string message_type;     ///< "sensor_msgs/LaserScan"
  messages::SensorRule rule{};  ///< see messages::SensorConversion; usually empty
  std::uint32_t width = 0;
  bool strict = false;
  /// Value of every channel before its first valid value. nullopt: no value.
  std::optional<double> initial{};
  /// `data_stamp` is the simulated time of the tick that first uses a message.
  bool simulated_stamp = false;
  std::uint32_t queue = 10;         ///< messages that may wait; 0: any number
  std::function<void()> arrived{};  ///< in the session's thread, after every message
  Keep keep{};                      ///< of every message that has arrived since the tick before
};

/// Ports: `out` [width]; `data_stamp` [1], the monotonic time in seconds at which the newest
/// message that this tick uses arrived, without value before the first.
///
/// Counters: messages, cropped, short_messages, invalid_readings, without_reading, malformed,
/// wrong_type, and over ROS 2 lost (RawSubscriber::lost()).
class Sensor : public TopicSource {
 public:
  /// Subscribes. @throws ConfigurationError as messages::SensorConversion, and
  /// for an impossible topic.
  Sensor(Session& session, const SensorSettings& settings);
  ~Sensor() override;

  /// Throws what the constructor would, without ROS.
  static void check(messages::Dialect ros, const SensorSettings& settings);

  std::vector<EndpointPort> ports() const override;
  /// @throws TransportError when the topic has brought messages of another type or version and none
  /// of the right one, or the session's node has been shut down; ConfigurationError when `strict`
  /// and a message does not fit the port.
  void receive(const Step& step) override;
  std::vector<Counter> counters() const override;

 private:
  const TopicReader& reader() const override;

  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace spikeloop::topics
