#include "spikeloop/ros1/sensor.hpp"

#include <fmt/format.h>
#include <topic_tools/shape_shifter.h>

#include <algorithm>
#include <exception>
#include <mutex>

#include "session_impl.hpp"
#include "spikeloop/core/error.hpp"
#include "spikeloop/core/log.hpp"
#include "spikeloop/core/pacer.hpp"
#include "spikeloop/messages/sensor_conversion.hpp"

namespace spikeloop::ros1 {
namespace {

using topic_tools::ShapeShifter;

constexpr std::uint32_t kQueue = 10;
constexpr TimeNs kPatience = 2 * kNsPerSecond;

messages::SensorConversion conversion_of(const SensorSettings& settings) {
  return {messages::Catalog::builtin(), settings.message_type, settings.fields, settings.width,
          settings.strict};
}

/// The message's bytes, without a copy of ours: ShapeShifter writes them into this "stream".
struct ByteSink {
  std::vector<std::byte>* bytes;
  std::uint8_t* advance(std::size_t size) const {
    bytes->resize(size);
    return reinterpret_cast<std::uint8_t*>(bytes->data());
  }
};

}  // namespace

struct Sensor::Impl {
  Impl(Session& used, const SensorSettings& wanted)
      : session(used),
        settings(wanted),
        conversion(conversion_of(wanted)),
        md5(messages::Catalog::builtin().md5(conversion.type())) {
    check_topic(settings.topic);
    newest.assign(settings.width, 0.0);
    subscriber = session.impl().node->subscribe<ShapeShifter>(
        settings.topic, kQueue,
        boost::function<void(const boost::shared_ptr<ShapeShifter const>&)>(
            [this](const boost::shared_ptr<ShapeShifter const>& message) { take(*message); }),
        ros::VoidConstPtr(), ros::TransportHints().tcpNoDelay());
  }

  /// In the session's thread, the moment a message has arrived.
  void take(const ShapeShifter& message) {
    const TimeNs now = wall_now();
    try {
      if (message.getMD5Sum() != md5) {
        refuse(message);
        return;
      }
      bytes.clear();
      ByteSink sink{&bytes};
      message.write(sink);
      const bool good = conversion.convert(bytes);
      const std::string warning = conversion.take_warning();
      publish(good, now);
      if (!warning.empty()) {
        log::warning("topic '{}': {}", settings.topic, warning);
      }
    } catch (...) {
      const std::lock_guard lock(mutex);
      failure = std::current_exception();
    }
  }

  void publish(bool good, TimeNs now) {
    const std::lock_guard lock(mutex);
    counts = conversion.counts();
    if (good) {
      std::ranges::copy(conversion.channels(), newest.begin());
      arrived = now;
      ++revision;
    }
  }

  void refuse(const ShapeShifter& message) {
    std::string text =
        message.getDataType() == conversion.type()
            ? fmt::format(
                  "topic '{}' carries another version of {} (md5 sum {}, ours is {}); its "
                  "publisher must use the version of ROS Noetic",
                  settings.topic, conversion.type(), message.getMD5Sum(), md5)
            : fmt::format(
                  "topic '{}' carries {}, not {}; write message_type={} or another ros_topic",
                  settings.topic, message.getDataType(), conversion.type(), message.getDataType());
    bool warn = false;
    {
      const std::lock_guard lock(mutex);
      warn = ++wrong_type == 1 && revision != 0;
      if (revision == 0) {
        failure = std::make_exception_ptr(TransportError(text));
      }
    }
    if (warn) {
      log::warning("{}", text);
    }
  }

  /// In the loop: says once that nothing comes, and once that nothing comes any more.
  void mind_silence(TimeNs now, TimeNs newest_at) {
    started = started == 0 ? now : started;
    bool& told = newest_at == 0 ? told_nothing_came : told_nothing_comes;
    if (told || now - std::max(started, newest_at) < kPatience) {
      return;
    }
    told = true;
    log::warning("no message has come on topic '{}' for {}; 'rostopic list' shows what there is",
                 settings.topic, format_time(kPatience));
  }

  Session& session;
  SensorSettings settings;
  messages::SensorConversion conversion;  // used in the session's thread only
  std::string md5;
  std::vector<std::byte> bytes;

  mutable std::mutex mutex;  // held for a copy, never across a tick
  std::vector<double> newest;
  TimeNs arrived = 0;
  std::uint64_t revision = 0;
  std::uint64_t wrong_type = 0;
  messages::SensorConversion::Counts counts;
  std::exception_ptr failure;

  std::uint64_t seen = 0;  // used by the loop only
  bool initial_sent = false;
  TimeNs started = 0;
  bool told_nothing_came = false;
  bool told_nothing_comes = false;
  ros::Subscriber subscriber;
};

Sensor::Sensor(Session& session, const SensorSettings& settings)
    : impl_(std::make_unique<Impl>(session, settings)) {}

void Sensor::check(const SensorSettings& settings) {
  conversion_of(settings);
  check_topic(settings.topic);
}

// Unsubscribing waits for a callback that is running.
Sensor::~Sensor() {
  impl_->subscriber.shutdown();
}

std::vector<EndpointPort> Sensor::ports() const {
  return {{"out", PortKind::signal, impl_->settings.width}, {"pace", PortKind::signal, 1}};
}

void Sensor::receive(const Step& step) {
  impl_->session.require_alive();
  const SignalOutput out = step.signal_output(0);
  const std::optional<double>& initial = impl_->settings.initial;
  if (initial && !impl_->initial_sent) {
    std::ranges::fill(out.values(), *initial);
    out.commit();
    impl_->initial_sent = true;
  }
  TimeNs arrived = 0;
  bool fresh = false;
  {
    const std::lock_guard lock(impl_->mutex);
    if (impl_->failure) {
      std::rethrow_exception(impl_->failure);
    }
    arrived = impl_->arrived;
    fresh = impl_->revision != impl_->seen;
    if (fresh) {
      impl_->seen = impl_->revision;
      std::ranges::copy(impl_->newest, out.values().begin());
    }
  }
  if (!fresh) {
    impl_->mind_silence(wall_now(), arrived);
    return;
  }
  out.commit();
  const SignalOutput pace = step.signal_output(1);
  pace.values()[0] = to_seconds(arrived);
  pace.commit();
}

std::vector<Counter> Sensor::counters() const {
  const std::lock_guard lock(impl_->mutex);
  const auto& counts = impl_->counts;
  return {{"messages", counts.messages},
          {"cropped", counts.cropped},
          {"short_messages", counts.short_messages},
          {"invalid_readings", counts.invalid_readings},
          {"without_reading", counts.without_reading},
          {"malformed", counts.malformed},
          {"wrong_type", impl_->wrong_type}};
}

}  // namespace spikeloop::ros1
