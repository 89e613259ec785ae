#include "spikeloop/messages/event_array.hpp"

#include <fmt/format.h>

#include "header.hpp"
#include "spikeloop/core/code.hpp"
#include "spikeloop/core/error.hpp"

namespace spikeloop::messages {
namespace {

constexpr std::uint32_t kMostPixels = 65'536;  // what 16 bits of an event can name

}  // namespace

EventArray::EventArray(std::span<const std::byte> message, Dialect dialect) {
  const bool aligned = dialect == Dialect::ros2;
  constexpr std::size_t kGap = 2;
  constexpr std::size_t kMostPadding = 3;  // which a transport may add, in ROS 2
  if (aligned) {
    stride_ = kAlignedEventBytes;
    gap_ = kGap;
  }
  with_reader(dialect, message, [&](auto& reader) {
    skip_header(reader, dialect);
    height_ = read_uint32(reader);
    width_ = read_uint32(reader);
    size_ = reader.length(kEventBytes);
    const std::size_t bytes = size_ == 0 ? 0 : (size_ - 1) * stride_ + kEventBytes;
    events_ = reader.take_bytes(bytes).data();
    if (reader.left() > (aligned ? kMostPadding : 0)) {
      throw TransportError(with_code(
          Code::damaged_message, "message of {} bytes goes on for {} bytes behind its last event",
          message.size(), reader.left()));
    }
  });
  if (height_ == 0 || width_ == 0 || height_ > kMostPixels || width_ > kMostPixels) {
    throw TransportError(
        with_code(Code::damaged_message,
                  "its camera has {} x {} pixels; the driver must set width and height, at most "
                  "{} each",
                  width_, height_, kMostPixels));
  }
}

}  // namespace spikeloop::messages
