#include "spikeloop/topics/sensor.hpp"

#include <algorithm>
#include <mutex>

#include "spikeloop/messages/catalog.hpp"
#include "spikeloop/messages/sensor_conversion.hpp"
#include "spikeloop/topics/names.hpp"
#include "topic_reader.hpp"

namespace spikeloop::topics {
namespace {

/// True for messages of many packets, which often arrive incomplete unless lost packets are sent
/// again.
bool is_large(messages::Dialect ros, const std::string& message_type) {
  const std::string type = messages::Catalog::for_type(ros, message_type).full_name(message_type);
  return type == "sensor_msgs/Image" || type == "sensor_msgs/CompressedImage" ||
         type == "sensor_msgs/PointCloud2";
}

messages::SensorConversion conversion_of(messages::Dialect ros, const SensorSettings& settings) {
  return {messages::Catalog::for_type(ros, settings.message_type),
          settings.message_type,
          settings.rule,
          settings.width,
          settings.strict,
          settings.initial};
}

}  // namespace

struct Sensor::Impl {
  Impl(Session& session, const SensorSettings& wanted)
      : settings(wanted),
        conversion(conversion_of(session.dialect(), wanted)),
        newest(conversion.channels().begin(), conversion.channels().end()),
        revision(wanted.initial ? 1 : 0),
        reader(session,
               {.node = wanted.node,
                .topic = wanted.topic,
                .type = wanted.message_type,
                .queue = wanted.queue,
                .type_is_a_key = true,
                .reliable = is_large(session.dialect(), wanted.message_type),
                .arrived = wanted.arrived},
               [this](std::span<const std::byte> bytes, TimeNs now) { return take(bytes, now); }) {}

  /// Called in the session's thread when a message has arrived.
  std::vector<std::string> take(std::span<const std::byte> bytes, TimeNs now) {
    const bool good = convert(bytes);
    // Update values and kept messages together, so that a tick uses exactly the kept messages.
    const std::lock_guard lock(mutex);
    if (settings.keep) {
      arrivals.emplace_back(bytes.begin(), bytes.end());
    }
    counts = conversion.counts();
    if (good || conversion.passes_nan()) {
      std::ranges::copy(conversion.channels(), newest.begin());
      ++revision;
    }
    if (good) {
      arrived = now;
      ++readings;
    }
    unread = conversion.unread();
    std::vector<std::string> warnings;
    for (std::string text = conversion.take_warning(); !text.empty();
         text = conversion.take_warning()) {
      warnings.push_back(std::move(text));
    }
    return warnings;
  }

  /// Counts a message of the wrong width, too. @throws as SensorConversion::convert
  bool convert(std::span<const std::byte> bytes) {
    try {
      return conversion.convert(bytes);
    } catch (...) {
      const std::lock_guard lock(mutex);
      counts = conversion.counts();
      throw;
    }
  }

  SensorSettings settings;
  messages::SensorConversion conversion;  // used in the session's thread only

  mutable std::mutex mutex;  // held while copying, never during a whole tick
  std::vector<double> newest;
  TimeNs arrived = 0;
  std::uint64_t revision;                        // revision of `newest`
  std::uint64_t readings = 0;                    // number of messages with a reading
  std::string unread;                            // SensorConversion::unread()
  std::vector<std::vector<std::byte>> arrivals;  // since the last tick, for `keep`
  messages::SensorConversion::Counts counts;

  std::uint64_t seen = 0;  // used by the loop only
  std::uint64_t seen_readings = 0;
  std::vector<std::vector<std::byte>> taken;
  TopicReader reader;  // last: its callbacks use all other members
};

Sensor::Sensor(Session& session, const SensorSettings& settings)
    : impl_(std::make_unique<Impl>(session, settings)) {}

void Sensor::check(messages::Dialect ros, const SensorSettings& settings) {
  conversion_of(ros, settings);
  check_topic(ros, settings.topic);
}

Sensor::~Sensor() {
  const std::lock_guard lock(impl_->mutex);
  if (!impl_->unread.empty()) {
    impl_->reader.warn(impl_->unread);
  }
}

std::vector<EndpointPort> Sensor::ports() const {
  return {{"out", PortKind::signal, impl_->settings.width}, {"data_stamp", PortKind::signal, 1}};
}

void Sensor::receive(const Step& step) {
  const bool simulated = impl_->settings.simulated_stamp;
  impl_->reader.check(simulated ? std::optional(step.interval().begin) : std::nullopt);
  const SignalOutput out = step.signal_output(0);
  TimeNs arrived = 0;
  bool fresh = false;
  bool stamped = false;
  {
    const std::lock_guard lock(impl_->mutex);
    arrived = impl_->arrived;
    fresh = impl_->revision != impl_->seen;
    stamped = impl_->readings != impl_->seen_readings;
    impl_->seen_readings = impl_->readings;
    if (fresh) {
      impl_->seen = impl_->revision;
      std::ranges::copy(impl_->newest, out.values().begin());
    }
    impl_->taken.swap(impl_->arrivals);
  }
  for (const auto& message : impl_->taken) {
    impl_->settings.keep(step.interval().begin, message);
  }
  impl_->taken.clear();
  if (fresh) {
    out.commit();
  }
  if (!stamped) {
    return;
  }
  const SignalOutput data_stamp = step.signal_output(1);
  data_stamp.values()[0] = to_seconds(simulated ? step.interval().begin : arrived);
  data_stamp.commit();
}

std::vector<Counter> Sensor::counters() const {
  const std::uint64_t wrong_type = impl_->reader.wrong_type();
  const std::lock_guard lock(impl_->mutex);
  const auto& counts = impl_->counts;
  std::vector<Counter> counters{{"messages", counts.messages},
                                {"cropped", counts.cropped},
                                {"short_messages", counts.short_messages},
                                {"invalid_readings", counts.invalid_readings},
                                {"without_reading", counts.without_reading},
                                {"malformed", counts.malformed},
                                {"wrong_type", wrong_type}};
  if (const auto lost = impl_->reader.lost()) {
    counters.push_back({"lost", *lost});
  }
  return counters;
}

const TopicReader& Sensor::reader() const {
  return impl_->reader;
}

}  // namespace spikeloop::topics
