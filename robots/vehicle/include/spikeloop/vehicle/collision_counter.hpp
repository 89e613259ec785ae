// When a contact is a collision.
#pragma once

#include <cstdint>
#include <map>

#include "spikeloop/core/time.hpp"

namespace spikeloop::vehicle {

/// Counts a collision when a contact with a thing begins: when there was none with it for half a
/// second. A lasting contact, or a bouncing one, is one collision; two things are two.
template <typename Thing>
class CollisionCounter {
 public:
  /// @param time not before that of the previous call
  void touch(const Thing& thing, TimeNs time) {
    const auto [last_touch, is_new] = last_touch_.try_emplace(thing, time);
    if (is_new || time - last_touch->second > kPause) ++count_;
    last_touch->second = time;
  }
  std::uint64_t count() const { return count_; }

 private:
  static constexpr TimeNs kPause = kNsPerSecond / 2;

  std::map<Thing, TimeNs> last_touch_;
  std::uint64_t count_ = 0;
};

}  // namespace spikeloop::vehicle
