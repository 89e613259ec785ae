// An event camera's topic as a source of spikes, each at its own time.
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
  std::string node{};  ///< its name in an experiment, for warnings; empty in a .music file
  std::string topic;
  messages::EventSettings events;
  TimeNs latency = 0;  ///< see messages::EventPlayback
  /// What has come before the first receive() is of the run, too: the robot waits for it. Else it
  /// is from before the run began, and is left out.
  bool from_begin = false;
  /// `data_stamp` and what is said of silence go by the simulated time of the tick that first uses
  /// a message.
  bool simulated_stamp = false;
  std::uint32_t queue = 1000;       ///< messages that may wait; 0: any number
  std::function<void()> arrived{};  ///< in the session's thread, after every message
  Keep keep{};
};

/// Ports: `out` [events.width], spikes; `data_stamp` [1], the monotonic time in seconds at which
/// the newest message that this tick uses arrived, without value before the first. The topic's type
/// is events.message_type.
///
/// Counters: messages, events; of these left_out, refractory, outside_camera, before_begin, which
/// are not sent, and waiting, which are not sent yet; late_events, worst_lateness_ns, clock_jumps,
/// malformed, wrong_type.
class EventSensor : public TopicSource {
 public:
  /// Subscribes. @throws ConfigurationError as check().
  EventSensor(Session& session, const EventSensorSettings& settings);
  ~EventSensor() override;

  /// @throws ConfigurationError for an impossible topic, and when a region does not fit the port.
  static void check(messages::Dialect ros, const EventSensorSettings& settings);

  std::vector<EndpointPort> ports() const override;
  /// @throws TransportError when the topic has brought messages of another type or version and none
  /// of the right one, or the session's node has been shut down; ConfigurationError when the camera
  /// does not fit the port.
  void receive(const Step& step) override;
  std::vector<Counter> counters() const override;

 private:
  const TopicReader& reader() const override;

  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace spikeloop::topics
