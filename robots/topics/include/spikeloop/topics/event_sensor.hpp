// An event camera's topic as a source of spikes, each at its own time.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "spikeloop/core/endpoint.hpp"
#include "spikeloop/messages/event_conversion.hpp"
#include "spikeloop/topics/session.hpp"

namespace spikeloop::topics {

struct EventSensorSettings {
  std::string topic;
  messages::EventSettings events;
  TimeNs latency = 0;  ///< see EventPlayback
};

/// Port: `out` [events.width], spikes. The topic's type is events.message_type.
///
/// Counters: messages, events; of these left_out, refractory, outside_camera, before_begin, which
/// are not sent, and waiting, which are not sent yet; late_events, worst_lateness_ns, clock_jumps,
/// malformed, wrong_type.
class EventSensor : public Source {
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
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace spikeloop::topics
