#include "spikeloop/topics/event_sensor.hpp"

#include <cmath>
#include <mutex>

#include "intake.hpp"
#include "spikeloop/core/log.hpp"
#include "spikeloop/topics/event_playback.hpp"
#include "spikeloop/topics/names.hpp"

namespace spikeloop::topics {
namespace {

/// No message is to be lost while the session's thread has no time.
constexpr std::uint32_t kQueue = 1000;

}  // namespace

struct EventSensor::Impl {
  Impl(Session& session, const EventSensorSettings& wanted)
      : settings(wanted),
        conversion(wanted.events, session.dialect()),
        playback(wanted.latency),
        intake(session,
               {.topic = wanted.topic, .type = wanted.events.message_type, .queue = kQueue},
               [this](std::span<const std::byte> bytes, TimeNs) { take(bytes); }) {}

  /// In the session's thread, the moment a message has arrived.
  void take(std::span<const std::byte> bytes) {
    messages::EventMessage message;
    const bool good = conversion.convert(bytes, message);
    const std::string warning = conversion.take_warning();
    {
      const std::lock_guard lock(mutex);
      counts = conversion.counts();
      if (good) {
        arrived.push_back(std::move(message));
      }
    }
    if (!warning.empty()) {
      log::warning("topic '{}': {}", settings.topic, warning);
    }
  }

  /// In the loop: says once that the latency is too short for the messages.
  void mind_lateness() {
    if (told_late || playback.late() == 0) {
      return;
    }
    told_late = true;
    const TimeNs enough = settings.latency + playback.worst_lateness();
    log::warning(
        "topic '{}': events come up to {} too late for latency={:g} and are sent as soon as they "
        "come; write latency={:g} to have them at their own times",
        settings.topic, format_time(playback.worst_lateness()), to_seconds(settings.latency),
        std::ceil(to_seconds(enough) * 1e3) / 1e3);
  }

  EventSensorSettings settings;
  messages::EventConversion conversion;  // used in the session's thread only

  mutable std::mutex mutex;  // held for a moment, never across a tick
  std::vector<messages::EventMessage> arrived;
  messages::EventConversion::Counts counts;

  std::vector<messages::EventMessage> taken;  // used by the loop only
  EventPlayback playback;
  bool told_late = false;
  Intake intake;  // last: no callback comes before there is all the rest, or after
};

EventSensor::EventSensor(Session& session, const EventSensorSettings& settings)
    : impl_(std::make_unique<Impl>(session, settings)) {}

EventSensor::~EventSensor() = default;

void EventSensor::check(messages::Dialect ros, const EventSensorSettings& settings) {
  check_topic(ros, settings.topic);
  const messages::EventConversion conversion(settings.events, ros);
}

std::vector<EndpointPort> EventSensor::ports() const {
  return {{"out", PortKind::spikes, impl_->settings.events.width}};
}

void EventSensor::receive(const Step& step) {
  impl_->intake.check();
  impl_->taken.clear();
  {
    const std::lock_guard lock(impl_->mutex);
    impl_->taken.swap(impl_->arrived);
  }
  step.spike_output().emit(impl_->playback.step(impl_->taken, step.interval()));
  impl_->mind_lateness();
}

std::vector<Counter> EventSensor::counters() const {
  const std::uint64_t wrong_type = impl_->intake.wrong_type();
  const EventPlayback& playback = impl_->playback;
  const std::lock_guard lock(impl_->mutex);
  const auto& counts = impl_->counts;
  return {{"messages", counts.messages},
          {"events", counts.events},
          {"left_out", counts.left_out},
          {"refractory", counts.refractory},
          {"outside_camera", counts.outside_camera},
          {"before_begin", playback.before_begin()},
          {"waiting", playback.waiting()},
          {"late_events", playback.late()},
          {"worst_lateness_ns", static_cast<std::uint64_t>(playback.worst_lateness())},
          {"clock_jumps", playback.clock_jumps()},
          {"malformed", counts.malformed},
          {"wrong_type", wrong_type}};
}

}  // namespace spikeloop::topics
