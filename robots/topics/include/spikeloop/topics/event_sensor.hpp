// Topic of an event camera as a source of spikes, each at its own time.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "spikeloop/messages/event_conversion.hpp"
#include "spikeloop/topics/session.hpp"
#include "spikeloop/topics/topic_source.hpp"

namespace spikeloop::topics {

struct EventSensorSettings {
  std::string node{};  ///< name for warnings; empty in a .music file
  std::string topic;
  messages::EventSettings events;
  TimeNs latency = 0;  ///< see messages::EventPlayback
  /// True if messages from before the first receive() belong to the run, because the robot waits
  /// for them. Otherwise they are left out.
  bool from_begin = false;
  /// True if `data_stamp` and warnings about missing messages use the simulated time of the tick
  /// that first uses a message.
  bool simulated_stamp = false;
  std::uint32_t queue = 1000;       ///< messages that may wait; 0: unlimited
  std::function<void()> arrived{};  ///< called in the session's thread after every message
  Keep keep{};
};

/// Ports: `out` [events.width], spikes; `data_stamp` [1], the monotonic time in seconds at which
/// the newest message of this tick arrived, without a value before the first message. The topic's
/// type is events.message_type.
///
/// Counters: messages, events; events that are not sent: left_out, refractory, outside_camera,
/// before_begin; events that are not sent yet: waiting; late_events, worst_lateness_ns,
/// clock_jumps, malformed, wrong_type.
class EventSensor : public TopicSource {
 public:
  /// Subscribes. @throws ConfigurationError as check().
  EventSensor(Session& session, const EventSensorSettings& settings);
  ~EventSensor() override;

  /// @throws ConfigurationError for an invalid topic, and if a region does not fit the port.
  static void check(messages::Dialect ros, const EventSensorSettings& settings);

  std::vector<EndpointPort> ports() const override;
  /// @throws TransportError if the topic carries only messages of another type or version, or if
  /// the session's node has been shut down; ConfigurationError if the camera does not fit the port.
  void receive(const Step& step) override;
  std::vector<Counter> counters() const override;

 private:
  const TopicReader& reader() const override;

  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace spikeloop::topics
