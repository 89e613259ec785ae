#include "subscriber.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>
#include <utility>
#include <vector>

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

/// Level of the first reader. Best effort suffices for most publishers. A publisher that is best
/// effort prints a warning about a reliable reader, so the first reader is reliable only where
/// every message counts.
Level first_level(const topics::Subscription& subscription) {
  return subscription.queue == 0 ? Level::reliable : Level::best_effort;
}

}  // namespace

Subscriber::Subscriber(Session::Impl& session, const Endpoint& endpoint,
                       topics::Subscription subscription)
    : session_(session),
      endpoint_(endpoint),
      subscription_(std::move(subscription)),
      topic_(session.participant.entity(), endpoint.dds_name(), endpoint.dds_type_name()),
      sources_(subscription_) {
  add_reader(first_level(subscription_));
  session_.acquaintance.subscribe(endpoint_.dds_name(), endpoint_.dds_type_name());
  listener_ = session_.graph.listen(
      endpoint_.dds_name(), [this](const Writer& writer, bool alive) { look_at(writer, alive); });
}

Subscriber::~Subscriber() {
  session_.graph.forget(listener_);
  session_.acquaintance.unsubscribe(endpoint_.dds_name(), endpoint_.dds_type_name());
}

std::string Subscriber::misfit() const {
  for (const Writer& writer : session_.graph.writers(endpoint_.dds_name())) {
    if (writer.type == endpoint_.dds_type_name() && !writer.misfit.empty()) {
      return writer.misfit;
    }
  }
  return {};
}

bool Subscriber::has_publishers() const {
  const std::lock_guard lock(mutex_);
  return std::ranges::any_of(readers_,
                             [](const auto& entry) { return entry.second->has_writers(); });
}

std::optional<std::uint64_t> Subscriber::lost() const {
  return sources_.lost(session_.left ? nullptr : topic_.type);
}

void Subscriber::take(Level level, const TakenMessage& taken) {
  if (!sources_.accept(level, taken.writer(), taken.number())) {
    return;
  }
  const std::span<const std::byte> message = taken.message();
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

void Subscriber::look_at(const Writer& writer, bool alive) {
  if (writer.type == endpoint_.dds_type_name()) {
    for (const Writer& other : session_.graph.writers(endpoint_.dds_name())) {
      if (other.type == writer.type) {
        sources_.update(other, true);
      }
    }
    if (!alive) {
      sources_.update(writer, false);
    }
    const std::vector<Level> levels = sources_.levels();
    for (const Level level : levels) {
      add_reader(level);
    }
    // A volatile publisher warns of a reader that requests what was published before.
    if (std::ranges::find(levels, Level::latched) == levels.end()) {
      remove_reader(Level::latched);
    }
    if (alive && sources_.level_of(writer.handle) == Level::reliable) {
      readers_.at(Level::reliable)->meet(writer);
    }
  }
  if (alive) {
    look_at_type(writer);
  }
}

void Subscriber::look_at_type(const Writer& writer) {
  if (writer.type != endpoint_.dds_type_name()) {
    refuse(topics::other_type(
        endpoint_.topic, ros_type(writer.type), endpoint_.message_type,
        [&nodes = session_.nodes, guid = writer.guid] { return nodes.node_of(guid); }));
    return;
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

void Subscriber::add_reader(Level level) {
  if (readers_.contains(level)) {
    return;
  }
  auto reader =
      std::make_unique<Reader>(session_, topic_,
                               reader_qos(subscription_.queue, level != Level::best_effort,
                                          level == Level::latched, endpoint_.user_data),
                               [this, level](const TakenMessage& taken) { take(level, taken); });
  const std::lock_guard lock(mutex_);
  readers_.emplace(level, std::move(reader));
}

void Subscriber::remove_reader(Level level) {
  std::unique_lock lock(mutex_);
  const auto removed = readers_.extract(level);
  lock.unlock();
}

void Subscriber::refuse(const topics::OtherType& other) {
  if (subscription_.refuse) {
    subscription_.refuse(other);
  }
}

}  // namespace spikeloop::ros2
