#include "spikeloop/messages/event_array.hpp"

#include <fmt/format.h>

#include "spikeloop/core/error.hpp"
#include "wire.hpp"

namespace spikeloop::messages {

EventArray::EventArray(std::span<const std::byte> message) {
  constexpr std::size_t kSequenceAndStamp = 12;
  constexpr std::uint32_t kMostPixels = 65'536;  // what 16 bits of an event can name
  Ros1Reader reader(message);
  reader.skip_bytes(kSequenceAndStamp);
  reader.skip_text();
  height_ = static_cast<std::uint32_t>(reader.number(Primitive::uint32));
  width_ = static_cast<std::uint32_t>(reader.number(Primitive::uint32));
  const std::size_t bytes = kEventBytes * reader.length(kEventBytes);
  if (reader.left() != bytes) {
    throw TransportError(
        fmt::format("message of {} bytes goes on for {} bytes behind its last event",
                    message.size(), reader.left() - bytes));
  }
  if (height_ == 0 || width_ == 0 || height_ > kMostPixels || width_ > kMostPixels) {
    throw TransportError(
        fmt::format("its camera has {} x {} pixels; the driver must set width and height, at most "
                    "{} each",
                    width_, height_, kMostPixels));
  }
  events_ = message.last(bytes);
}

}  // namespace spikeloop::messages
