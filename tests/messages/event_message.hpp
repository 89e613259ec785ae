// Bytes of a dvs_msgs/EventArray, put together by hand.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace spikeloop::test {

struct RawEvent {
  std::uint16_t x = 0;
  std::uint16_t y = 0;
  std::uint32_t seconds = 0;
  std::uint32_t nanoseconds = 0;
  bool on = false;
};

inline void append_number(std::vector<std::byte>& bytes, std::uint64_t value, int count) {
  for (int i = 0; i < count; ++i) {
    bytes.push_back(static_cast<std::byte>(value >> (8 * i)));
  }
}

inline std::vector<std::byte> event_message(std::uint32_t width, std::uint32_t height,
                                            std::span<const RawEvent> events,
                                            const std::string& frame = "dvs") {
  std::vector<std::byte> bytes;
  append_number(bytes, 7, 4);            // sequence
  append_number(bytes, 1'000'000, 4);    // stamp
  append_number(bytes, 500'000'000, 4);  // its nanoseconds
  append_number(bytes, frame.size(), 4);
  for (const char c : frame) {
    bytes.push_back(static_cast<std::byte>(c));
  }
  append_number(bytes, height, 4);
  append_number(bytes, width, 4);
  append_number(bytes, events.size(), 4);
  for (const RawEvent& event : events) {
    append_number(bytes, event.x, 2);
    append_number(bytes, event.y, 2);
    append_number(bytes, event.seconds, 4);
    append_number(bytes, event.nanoseconds, 4);
    append_number(bytes, event.on ? 1 : 0, 1);
  }
  return bytes;
}

}  // namespace spikeloop::test
