#include "spikeloop/topics/event_sensor.hpp"

#include <atomic>
#include <cmath>
#include <mutex>

#include "spikeloop/core/log.hpp"
#include "spikeloop/messages/event_playback.hpp"
#include "spikeloop/topics/names.hpp"
#include "topic_reader.hpp"

namespace spikeloop::topics {
namespace {

/// A message as bytes and as events.
struct Arrival {
  messages::EventMessage events{};
  std::vector<std::byte> bytes{};  ///< empty if messages are not recorded
  TimeNs at = 0;
  bool good = false;
};

}  // namespace

struct EventSensor::Impl {
  Impl(Session& session, const EventSensorSettings& wanted)
      : settings(wanted),
        conversion(wanted.events, session.dialect()),
        begun(wanted.from_begin),
        playback(wanted.latency),
        reader(session,
               {.node = wanted.node,
                .topic = wanted.topic,
                .type = wanted.events.message_type,
                .queue = wanted.queue,
                .reliable = true,
                .arrived = wanted.arrived},
               [this](std::span<const std::byte> bytes, TimeNs now) { return take(bytes, now); }) {}

  /// Called in the session's thread when a message has arrived.
  std::vector<std::string> take(std::span<const std::byte> bytes, TimeNs now) {
    const bool of_run = begun;
    if (of_run && !restarted) {
      // The run must not depend on earlier messages, so that its own messages reproduce it.
      conversion.restart();
      restarted = true;
    }
    Arrival arrival{.at = now};
    try {
      arrival.good = conversion.convert(bytes, arrival.events);
    } catch (...) {  // count the message of another camera, too
      const std::lock_guard lock(mutex);
      counts = conversion.counts();
      throw;
    }
    if (settings.keep) {
      arrival.bytes.assign(bytes.begin(), bytes.end());
    }
    const std::lock_guard lock(mutex);
    counts = conversion.counts();
    if (of_run) {
      arrivals.push_back(std::move(arrival));
    } else {
      before_begin += arrival.events.events.size();
    }
    std::string warning = conversion.take_warning();
    return warning.empty() ? std::vector<std::string>{} : std::vector{std::move(warning)};
  }

  /// Called in the loop. Takes the messages since the last tick.
  void take_arrivals(TimeNs begin) {
    begun = true;
    taken.clear();
    {
      const std::lock_guard lock(mutex);
      taken.swap(arrivals);
    }
    fresh.clear();
    for (Arrival& arrival : taken) {
      if (settings.keep) {
        settings.keep(begin, arrival.bytes);
      }
      if (arrival.good) {
        newest_at = arrival.at;
        fresh.push_back(std::move(arrival.events));
      }
    }
  }

  /// Called in the loop. Warns once if the latency is too short for the messages.
  void warn_of_lateness() {
    if (warned_of_lateness || playback.late() == 0) {
      return;
    }
    warned_of_lateness = true;
    const TimeNs enough = settings.latency + playback.worst_lateness();
    log::warning(
        "topic '{}': events arrive up to {} too late for latency={:g} and are sent at once; "
        "write latency={:g} to send them at their own times",
        settings.topic, format_time(playback.worst_lateness()), to_seconds(settings.latency),
        std::ceil(to_seconds(enough) * 1e3) / 1e3);
  }

  EventSensorSettings settings;
  messages::EventConversion conversion;  // used in the session's thread only
  bool restarted = settings.from_begin;

  std::atomic<bool> begun;
  mutable std::mutex mutex;  // never held during a whole tick
  std::vector<Arrival> arrivals;
  messages::EventConversion::Counts counts;
  std::uint64_t before_begin = 0;  // number of events

  std::vector<Arrival> taken;  // used by the loop only
  std::vector<messages::EventMessage> fresh;
  TimeNs newest_at = 0;
  messages::EventPlayback playback;
  bool warned_of_lateness = false;
  TopicReader reader;  // last: its callbacks use all other members
};

EventSensor::EventSensor(Session& session, const EventSensorSettings& settings)
    : impl_(std::make_unique<Impl>(session, settings)) {}

EventSensor::~EventSensor() = default;

void EventSensor::check(messages::Dialect ros, const EventSensorSettings& settings) {
  check_topic(ros, settings.topic);
  const messages::EventConversion conversion(settings.events, ros);
}

std::vector<EndpointPort> EventSensor::ports() const {
  return {{"out", PortKind::spikes, impl_->settings.events.width},
          {"data_stamp", PortKind::signal, 1}};
}

void EventSensor::receive(const Step& step) {
  const TimeNs begin = step.interval().begin;
  const bool simulated = impl_->settings.simulated_stamp;
  impl_->reader.check(simulated ? std::optional(begin) : std::nullopt);
  impl_->take_arrivals(begin);
  step.spike_output().emit(impl_->playback.step(impl_->fresh, step.interval()));
  impl_->warn_of_lateness();
  if (!impl_->fresh.empty()) {
    const SignalOutput data_stamp = step.signal_output();
    data_stamp.values()[0] = to_seconds(simulated ? begin : impl_->newest_at);
    data_stamp.commit();
  }
}

std::vector<Counter> EventSensor::counters() const {
  const std::uint64_t wrong_type = impl_->reader.wrong_type();
  const messages::EventPlayback& playback = impl_->playback;
  const std::lock_guard lock(impl_->mutex);
  const auto& counts = impl_->counts;
  return {{"messages", counts.messages},
          {"events", counts.events},
          {"left_out", counts.left_out},
          {"refractory", counts.refractory},
          {"outside_camera", counts.outside_camera},
          {"before_begin", impl_->before_begin},
          {"waiting", playback.waiting()},
          {"late_events", playback.late()},
          {"worst_lateness_ns", static_cast<std::uint64_t>(playback.worst_lateness())},
          {"clock_jumps", playback.clock_jumps()},
          {"malformed", counts.malformed},
          {"wrong_type", wrong_type}};
}

const TopicReader& EventSensor::reader() const {
  return impl_->reader;
}

}  // namespace spikeloop::topics
