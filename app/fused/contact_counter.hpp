// Collisions of a robot that is not ours, from the contacts that its simulator publishes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <utility>

#include "spikeloop/messages/field_path.hpp"
#include "spikeloop/topics/session.hpp"
#include "spikeloop/vehicle/collision_counter.hpp"

namespace spikeloop {

/// Counts collisions in what comes on /bumper_states (gazebo_msgs/ContactsState), as
/// vehicle::CollisionCounter does for our own robot. A thing is a pair of collision bodies, by
/// their names in the message. Contacts before the first tick do not count.
class ContactCounter {
 public:
  explicit ContactCounter(topics::Session& session);

  /// Contacts that come from now on are of this time.
  void tick(TimeNs time);
  /// So far; nothing when no message has come.
  std::optional<std::uint64_t> count() const;

 private:
  void take(std::span<const std::byte> message);

  messages::TextField first_;
  messages::TextField second_;
  mutable std::mutex mutex_;
  std::optional<TimeNs> now_;
  std::optional<vehicle::CollisionCounter<std::pair<std::string, std::string>>> counter_;
  std::unique_ptr<topics::RawSubscriber> subscriber_;  ///< last: its callback uses the others
};

}  // namespace spikeloop
