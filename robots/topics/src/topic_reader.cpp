#include "topic_reader.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "spikeloop/core/code.hpp"
#include "spikeloop/core/error.hpp"
#include "spikeloop/core/log.hpp"
#include "spikeloop/core/pacer.hpp"
#include "spikeloop/topics/names.hpp"
#include "spikeloop/topics/topic_source.hpp"

namespace spikeloop::topics {
namespace {

constexpr TimeNs kPatience = 2 * kNsPerSecond;
constexpr TimeNs kLook = kNsPerSecond / 10;
/// Minimum number of messages for a warning about loss; one in kLargePart must be lost.
constexpr std::uint64_t kLeastForLoss = 20;
constexpr std::uint64_t kLargePart = 10;
constexpr TimeNs kSuspension = kNsPerSecond;

/// Command that lists the topics, with the place of this node: a wrong place is the most frequent
/// cause of missing messages.
std::string how_to_look(const Session& session) {
  if (session.local()) {
    return {};
  }
  const Place place = session.place();
  const char* const variable =
      session.dialect() == messages::Dialect::ros1 ? "ROS_MASTER_URI" : "ROS_DOMAIN_ID";
  const auto found = place.find(variable);
  return fmt::format(
      "; '{} list' shows what there is with {}", topic_command(session.dialect()),
      found == place.end() ? std::string() : fmt::format("{}={}", variable, found->second));
}

}  // namespace

TopicReader::TopicReader(Session& session, const TopicReaderSettings& settings, Take take)
    : session_(session), settings_(settings), take_(std::move(take)) {
  check_topic(session.dialect(), settings_.topic);
  topic_ = session.whole_topic(settings_.topic);
  subscriber_ =
      session.subscriber({.topic = settings_.topic,
                          .message_type = settings_.type,
                          .queue = settings_.queue,
                          .reliable = settings_.reliable,
                          .latched = settings_.takes_latched(),
                          .take = [this](auto message) { receive(message); },
                          .refuse = [this](const auto& other) { other_types_.add(other); }});
}

void TopicReader::receive(std::span<const std::byte> message) {
  const TimeNs now = wall_now();
  try {
    const std::vector<std::string> warnings = take_(message, now);
    ++received_;
    if (settings_.arrived) {
      settings_.arrived();
    }
    for (const std::string& warning : warnings) {
      warn(warning);
    }
    const std::lock_guard lock(mutex_);
    newest_at_ = now;
  } catch (const ConfigurationError& error) {
    const std::lock_guard lock(mutex_);
    failure_ = error.located() ? std::current_exception()
                               : std::make_exception_ptr(ConfigurationError(
                                     fmt::format("topic '{}': {}", settings_.topic, error.what())));
  } catch (...) {
    const std::lock_guard lock(mutex_);
    failure_ = std::current_exception();
  }
}

void TopicReader::warn(const std::string& text) const {
  log::warning("{}topic '{}': {}",
               settings_.node.empty() ? "" : fmt::format("node '{}': ", settings_.node),
               settings_.topic, text);
}

/// Throws if no message of the right type has arrived, otherwise warns.
void TopicReader::report_other_types() const {
  while (const auto other = other_types_.take()) {
    std::string text = other->text;
    if (!other->type.empty()) {
      text += settings_.type_is_a_key ? fmt::format("; {}, or another topic",
                                                    remedy_for_type(other->type, settings_.type))
                                      : "; write another topic";
    }
    const std::lock_guard lock(mutex_);
    if (newest_at_ == 0) {
      throw TransportError(with_code(Code::wrong_message, text));
    }
    log::warning("{}", text);
  }
}

/// True if packets or announcements of messages arrive, but no message.
bool TopicReader::all_messages_incomplete() {
  looked_at_ = wall_now();
  return lost().value_or(0) > 0 && has_publishers();
}

/// Warns once if a large part of the messages is lost. Losses while the loop is suspended do not
/// count.
void TopicReader::warn_of_loss() {
  const TimeNs now = wall_now();
  if (warned_of_loss_ || now - loss_checked_at_ < kLook) {
    return;
  }
  const bool suspended = now - loss_checked_at_ > kSuspension;
  loss_checked_at_ = now;
  const Window current{.begin = now, .received = received_, .lost = lost().value_or(0)};
  const std::uint64_t lost = current.lost - window_.lost;
  const std::uint64_t sent = current.received - window_.received + lost;
  if (suspended) {
    window_ = current;
    return;
  }
  if (now - window_.begin < kPatience || sent < kLeastForLoss) {
    return;
  }
  window_ = current;
  if (lost * kLargePart < sent) {
    return;
  }
  warned_of_loss_ = true;
  const std::string text =
      fmt::format("topic '{}': {} of {} messages were lost", topic_, lost, sent);
  if (subscriber_->dropped_packets() > 0) {
    log::warning(
        "{}, because the receive buffer is too small for them; give the system a larger one: "
        "sysctl "
        "-w net.core.rmem_max=8388608  (for a container: on its host), or publish reliably",
        text);
  } else {
    log::warning(
        "{}, but not by the receive buffer of this machine; look at the network and the load of "
        "this machine, or publish reliably",
        text);
  }
}

void TopicReader::warn_if_silent(TimeNs now, TimeNs newest_at) {
  started_ = started_ == 0 ? now : started_;
  if (newest_at == 0 && wall_now() - looked_at_ >= kLook) {
    all_messages_incomplete();  // announced messages count from the first call on
  }
  bool& warned = newest_at == 0 ? warned_of_no_message_ : warned_of_silence_;
  if (warned || (newest_at != 0 && subscriber_->latched()) ||
      now - std::max(started_, newest_at) < kPatience ||
      session_.has_warned_of_unreachable_node(topic_)) {
    return;
  }
  warned = true;
  if (newest_at == 0 && all_messages_incomplete()) {
    log::warning(
        "topic '{}' has a publisher, but no message of it arrives whole; give the system a larger "
        "receive buffer: sysctl -w net.core.rmem_max=8388608",
        topic_);
    return;
  }
  if (const std::string misfit = subscriber_->misfit(); !misfit.empty()) {
    log::warning(
        "messages of a publisher of '{}' are not received, because it offers {}; give it the "
        "default quality "
        "of service",
        topic_, misfit);
    return;
  }
  log::warning("no message on topic '{}' for {}{}", topic_, format_time(kPatience),
               how_to_look(session_));
}

void TopicReader::require_sound() const {
  session_.require_alive();
  {
    const std::lock_guard lock(mutex_);
    if (failure_) {
      std::rethrow_exception(failure_);
    }
  }
  report_other_types();
}

void TopicReader::check(std::optional<TimeNs> simulated) {
  require_sound();
  warn_of_loss();
  TimeNs newest_at = 0;
  {
    const std::lock_guard lock(mutex_);
    newest_at = newest_at_;
  }
  if (!simulated) {
    warn_if_silent(wall_now(), newest_at);
    return;
  }
  const TimeNs now = *simulated + 1;  // 0 means that no message has arrived
  if (newest_at != noticed_) {
    noticed_ = newest_at;
    noticed_at_ = now;
  }
  warn_if_silent(now, noticed_at_);
}

bool TopicSource::has_publishers() const {
  return reader().has_publishers();
}

std::uint64_t TopicSource::received() const {
  return reader().received();
}

void TopicSource::require_sound() const {
  reader().require_sound();
}

}  // namespace spikeloop::topics
