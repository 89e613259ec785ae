// What an event camera saw: dvs_msgs/EventArray in ROS 1's serialization.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>

#include "spikeloop/core/time.hpp"

namespace spikeloop::messages {

/// A pixel that became brighter (on) or darker.
struct CameraEvent {
  TimeNs stamp = 0;  ///< of the sensor's clock
  std::uint16_t x = 0;
  std::uint16_t y = 0;
  bool on = false;
};

/// A view of a message's bytes, which must outlive it. A reader of its own, because cameras bring
/// millions of events a second, and each of the fields by their names would cost a walk.
class EventArray {
 public:
  static constexpr std::size_t kEventBytes = 13;  ///< x, y: uint16; seconds, ns: uint32; bool

  /// @throws TransportError when the message ends too early or goes on behind its last event, and
  /// when its camera has no pixels, or more than the events can name.
  explicit EventArray(std::span<const std::byte> message);

  std::uint32_t height() const { return height_; }
  std::uint32_t width() const { return width_; }
  std::size_t size() const { return events_.size() / kEventBytes; }
  CameraEvent operator[](std::size_t i) const {
    const std::byte* const at = events_.data() + i * kEventBytes;
    return {kNsPerSecond * load<std::uint32_t>(at + 4) + load<std::uint32_t>(at + 8),
            load<std::uint16_t>(at), load<std::uint16_t>(at + 2), at[12] != std::byte{0}};
  }

 private:
  template <typename T>
  static T load(const std::byte* at) {
    T value{};
    std::memcpy(&value, at, sizeof(T));
    return value;
  }

  std::uint32_t height_ = 0;
  std::uint32_t width_ = 0;
  std::span<const std::byte> events_;
};

}  // namespace spikeloop::messages
