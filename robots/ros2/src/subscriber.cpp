#include "subscriber.hpp"

#include <fmt/format.h>

#include <string_view>
#include <utility>

#include "qos.hpp"
#include "spikeloop/core/error.hpp"
#include "spikeloop/core/log.hpp"

namespace spikeloop::ros2 {
namespace {

bool is_plain_little_endian(std::span<const std::byte> message) {
  return message[0] == std::byte{0} && message[1] == std::byte{1};
}

/// "RIHS01_..." of "typehash=RIHS01_...;"; empty where there is none, or nothing but zeros, which
/// is what ROS 2 writes for one that it does not know.
std::string type_hash_in(const std::string& user_data) {
  constexpr std::string_view kKey = "typehash=";
  const auto begin = user_data.find(kKey);
  if (begin == std::string::npos) {
    return {};
  }
  const auto value = begin + kKey.size();
  const std::string hash = user_data.substr(value, user_data.find(';', value) - value);
  const auto digits = hash.find('_');
  const bool known =
      digits != std::string::npos && hash.find_first_not_of('0', digits + 1) != std::string::npos;
  return known ? hash : std::string();
}

/// From the first message on. What is latched is one message, and no later one makes up for it.
bool is_reliable(const topics::Subscription& subscription) {
  return subscription.queue == 0 || subscription.latched;
}

}  // namespace

Subscriber::Subscriber(Session::Impl& session, const Endpoint& endpoint,
                       topics::Subscription subscription)
    : session_(session),
      endpoint_(endpoint),
      subscription_(std::move(subscription)),
      topic_(session.participant.entity(), endpoint.dds_name(), endpoint.dds_type_name()),
      reader_(session, topic_,
              reader_qos(subscription_.queue, is_reliable(subscription_), subscription_.latched,
                         endpoint.user_data),
              Writers::any, [this](auto message) { take(message); }) {
  if (subscription_.queue == 0) {
    other_.emplace(session, topic_, reader_qos(0, false, false, endpoint.user_data),
                   Writers::best_effort, [this](auto message) { take(message); });
  }
  session_.acquaintance.subscribe(endpoint_.dds_name(), endpoint_.dds_type_name());
  listener_ = session_.graph.listen(endpoint_.dds_name(),
                                    [this](const Writer& writer) { look_at(writer); });
}

Subscriber::~Subscriber() {
  session_.graph.forget(listener_);
  session_.acquaintance.unsubscribe(endpoint_.dds_name(), endpoint_.dds_type_name());
}

bool Subscriber::has_publishers() const {
  const std::lock_guard lock(mutex_);
  return reader_.has_writers() || (other_ && other_->has_writers());
}

std::optional<std::uint64_t> Subscriber::lost() const {
  const std::lock_guard lock(mutex_);
  return reader_.lost() + (other_ ? other_->lost() : 0);
}

void Subscriber::take(std::span<const std::byte> message) {
  if (is_plain_little_endian(message)) {
    subscription_.take(message);
  } else if (!std::exchange(complained_, true)) {
    log::warning(
        "messages on '{}' come in an encoding other than XCDR1, little endian (they begin with "
        "{:02x} "
        "{:02x}, not 00 01), and are ignored",
        endpoint_.topic, std::to_integer<int>(message[0]), std::to_integer<int>(message[1]));
  }
}

void Subscriber::look_at(const Writer& writer) {
  if (writer.type != endpoint_.dds_type_name()) {
    refuse(topics::other_type(endpoint_.topic, ros_type(writer.type), endpoint_.message_type));
    return;
  }
  if (writer.reliable && !subscription_.latched) {
    read_reliably(writer);
  }
  const std::string theirs = type_hash_in(writer.user_data);
  const std::string ours = type_hash_in(endpoint_.user_data);
  if (!theirs.empty() && theirs != ours) {
    refuse({.type = "",
            .text = fmt::format("topic '{}' carries another version of {}: its type hash is {}, "
                                "ours {}; write the path of the publisher's .msg file as the type",
                                endpoint_.topic, endpoint_.message_type, theirs, ours)});
  }
}

/// Where it is no matter of the first message, a reliable reader comes with the first publisher for
/// it: to one that is best effort, ROS 2 says that such a reader does not fit.
void Subscriber::read_reliably(const Writer& writer) {
  if (is_reliable(subscription_)) {
    reader_.meet(writer);
    return;
  }
  if (!subscription_.reliable) {
    return;
  }
  if (!other_) {
    const std::lock_guard lock(mutex_);
    reader_.restrict_to(Writers::best_effort);
    other_.emplace(session_, topic_,
                   reader_qos(subscription_.queue, true, false, endpoint_.user_data), Writers::any,
                   [this](auto message) { take(message); });
  }
  other_->meet(writer);
}

void Subscriber::refuse(const topics::OtherType& other) {
  if (subscription_.refuse) {
    subscription_.refuse(other);
  }
}

}  // namespace spikeloop::ros2
