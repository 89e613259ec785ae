#include "intake.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "spikeloop/core/error.hpp"
#include "spikeloop/core/log.hpp"
#include "spikeloop/core/pacer.hpp"
#include "spikeloop/messages/catalog.hpp"

namespace spikeloop::ros1 {
namespace {

constexpr TimeNs kPatience = 2 * kNsPerSecond;

/// The message's bytes, without a copy of ours: ShapeShifter writes them into this "stream".
struct ByteSink {
  std::vector<std::byte>* bytes;
  std::uint8_t* advance(std::size_t size) const {
    bytes->resize(size);
    return reinterpret_cast<std::uint8_t*>(bytes->data());
  }
};

}  // namespace

Intake::Intake(Session& session, const IntakeSettings& settings, Take take)
    : session_(session),
      settings_(settings),
      md5_(messages::Catalog::for_type(messages::Dialect::ros1, settings.type).md5(settings.type)),
      take_(std::move(take)) {
  check_topic(settings_.topic);
  subscriber_ = session.impl().node->subscribe<ShapeShifter>(
      settings_.topic, settings_.queue,
      boost::function<void(const boost::shared_ptr<ShapeShifter const>&)>(
          [this](const boost::shared_ptr<ShapeShifter const>& message) { receive(*message); }),
      ros::VoidConstPtr(), ros::TransportHints().tcpNoDelay());
}

// Unsubscribing waits for a callback that is running.
Intake::~Intake() {
  subscriber_.shutdown();
}

void Intake::receive(const ShapeShifter& message) {
  const TimeNs now = wall_now();
  try {
    if (message.getMD5Sum() != md5_) {
      refuse(message);
      return;
    }
    bytes_.clear();
    ByteSink sink{&bytes_};
    message.write(sink);
    take_(bytes_, now);
    const std::lock_guard lock(mutex_);
    newest_at_ = now;
  } catch (...) {
    const std::lock_guard lock(mutex_);
    failure_ = std::current_exception();
  }
}

void Intake::refuse(const ShapeShifter& message) {
  const std::string text =
      message.getDataType() == settings_.type
          ? fmt::format(
                "topic '{}' carries another version of {} (md5 sum {}, ours is {}); its "
                "publisher must use the version of ROS Noetic",
                settings_.topic, settings_.type, message.getMD5Sum(), md5_)
          : fmt::format("topic '{}' carries {}, not {}; write {}another ros_topic", settings_.topic,
                        message.getDataType(), settings_.type,
                        settings_.type_is_a_key
                            ? fmt::format("message_type={} or ", message.getDataType())
                            : "");
  bool warn = false;
  {
    const std::lock_guard lock(mutex_);
    warn = ++wrong_type_ == 1 && newest_at_ != 0;
    if (newest_at_ == 0) {
      failure_ = std::make_exception_ptr(TransportError(text));
    }
  }
  if (warn) {
    log::warning("{}", text);
  }
}

void Intake::mind_silence(TimeNs now, TimeNs newest_at) {
  started_ = started_ == 0 ? now : started_;
  bool& told = newest_at == 0 ? told_nothing_came_ : told_nothing_comes_;
  if (told || now - std::max(started_, newest_at) < kPatience) {
    return;
  }
  told = true;
  log::warning("no message has come on topic '{}' for {}; 'rostopic list' shows what there is",
               settings_.topic, format_time(kPatience));
}

void Intake::require_sound() const {
  session_.require_alive();
  const std::lock_guard lock(mutex_);
  if (failure_) {
    std::rethrow_exception(failure_);
  }
}

void Intake::check(std::optional<TimeNs> simulated) {
  require_sound();
  TimeNs newest_at = 0;
  {
    const std::lock_guard lock(mutex_);
    newest_at = newest_at_;
  }
  if (!simulated) {
    mind_silence(wall_now(), newest_at);
    return;
  }
  const TimeNs now = *simulated + 1;  // 0: none has come
  if (newest_at != noticed_) {
    noticed_ = newest_at;
    noticed_at_ = now;
  }
  mind_silence(now, noticed_at_);
}

std::uint64_t Intake::wrong_type() const {
  const std::lock_guard lock(mutex_);
  return wrong_type_;
}

}  // namespace spikeloop::ros1
