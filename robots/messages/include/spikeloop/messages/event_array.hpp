// What an event camera saw: dvs_msgs/EventArray.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>

#include "spikeloop/core/time.hpp"
#include "spikeloop/messages/dialect.hpp"

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
  /// x, y: uint16; seconds, nanoseconds: 32 bits; bool. ROS 1 has event behind event. In ROS 2 the
  /// seconds must stand at multiples of 4: 16 bytes apart, with x and y right behind the event
  /// before and 2 bytes of padding behind them, but in the first event.
  static constexpr std::size_t kEventBytes = 13;
  static constexpr std::size_t kAlignedEventBytes = 16;

  /// @throws TransportError when the message ends too early or goes on behind its last event, and
  /// when its camera has no pixels, or more than the events can name.
  EventArray(std::span<const std::byte> message, Dialect dialect);

  std::uint32_t height() const { return height_; }
  std::uint32_t width() const { return width_; }
  std::size_t size() const { return size_; }
  CameraEvent operator[](std::size_t i) const {
    const std::byte* const at = events_ + i * stride_;
    const std::byte* const pixel = at - (i == 0 ? 0 : gap_);
    return {kNsPerSecond * load<std::uint32_t>(at + 4) + load<std::uint32_t>(at + 8),
            load<std::uint16_t>(pixel), load<std::uint16_t>(pixel + 2), at[12] != std::byte{0}};
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
  std::size_t size_ = 0;
  const std::byte* events_ = nullptr;
  std::size_t stride_ = kEventBytes;
  std::size_t gap_ = 0;  ///< bytes by which x and y stand nearer to the event before
};

}  // namespace spikeloop::messages
