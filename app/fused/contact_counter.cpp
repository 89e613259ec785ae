#include "contact_counter.hpp"

#include <algorithm>
#include <string_view>
#include <vector>

#include "optional_subscriber.hpp"
#include "spikeloop/core/error.hpp"
#include "spikeloop/messages/catalog.hpp"

namespace spikeloop {
namespace {

constexpr const char* kContactsTopic = "bumper_states";  // of gazebo_ros_bumper
constexpr const char* kContactsType = "gazebo_msgs/ContactsState";

messages::TextField name_field(const topics::Session& session, const char* path) {
  return {messages::Catalog::for_type(session.dialect(), kContactsType), kContactsType, path};
}

}  // namespace

ContactCounter::ContactCounter(topics::Session& session)
    : first_(name_field(session, "states.collision1_name")),
      second_(name_field(session, "states.collision2_name")),
      subscriber_(
          optional_subscriber(session, {.topic = kContactsTopic,
                                        .message_type = kContactsType,
                                        .queue = 10,  // a short contact is in one message alone
                                        .take = [this](auto message) { take(message); },
                                        .refuse = [](const auto&) {}})) {}

/// In the session's thread.
void ContactCounter::take(std::span<const std::byte> message) {
  std::vector<std::string_view> first;
  std::vector<std::string_view> second;
  try {
    first_.read(message, first);
    second_.read(message, second);
  } catch (const Error&) {
    return;  // the experiment does not depend on it
  }
  const std::lock_guard lock(mutex_);
  if (!now_) {
    return;
  }
  if (!counter_) {
    counter_.emplace();
  }
  for (std::size_t i = 0; i < first.size(); ++i) {
    counter_->touch(std::minmax(std::string(first[i]), std::string(second[i])), *now_);
  }
}

void ContactCounter::tick(TimeNs time) {
  const std::lock_guard lock(mutex_);
  now_ = time;
}

std::optional<std::uint64_t> ContactCounter::count() const {
  const std::lock_guard lock(mutex_);
  return counter_ ? std::optional(counter_->count()) : std::nullopt;
}

}  // namespace spikeloop
