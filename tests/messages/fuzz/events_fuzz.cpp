// Packets of an event camera under libFuzzer (scripts/fuzz). The first byte says their encoding,
// the second what is taken of the camera; then packet by packet how many bytes it has, how many
// packets were lost before it, and these bytes. Whatever they are, events have channels of the
// port, and all of them are played once, in order, each in its interval.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "spikeloop/core/error.hpp"
#include "spikeloop/messages/event_conversion.hpp"
#include "spikeloop/messages/event_decoder.hpp"
#include "spikeloop/messages/event_playback.hpp"

using namespace spikeloop;
using namespace spikeloop::messages;

namespace {

constexpr std::string_view kEncodings[] = {"evt3", "evt2", "mono", "evt4"};
constexpr std::uint32_t kWidth = 2000;
constexpr std::uint32_t kHeight = 100;
constexpr TimeNs kTick = 5'000'000;

void need(bool condition) {
  if (!condition) {
    std::abort();
  }
}

void put(std::vector<std::byte>& bytes, std::uint64_t value, int count) {
  for (int i = 0; i < count; ++i) {
    bytes.push_back(static_cast<std::byte>(value >> (8 * i)));
  }
}

/// As ROS 1 has them.
std::vector<std::byte> packet(std::string_view encoding, bool big_endian, std::uint64_t sequence,
                              std::span<const std::uint8_t> events) {
  std::vector<std::byte> bytes(16);  // a header without a frame
  put(bytes, kHeight, 4);
  put(bytes, kWidth, 4);
  put(bytes, sequence, 8);
  put(bytes, sequence << 40U, 8);  // the time of `mono`
  put(bytes, encoding.size(), 4);
  for (const char letter : encoding) {
    bytes.push_back(static_cast<std::byte>(letter));
  }
  put(bytes, big_endian ? 1 : 0, 1);
  put(bytes, events.size(), 4);
  const auto more = std::as_bytes(events);
  bytes.insert(bytes.end(), more.begin(), more.end());
  return bytes;
}

EventSettings settings_of(unsigned choice) {
  EventSettings settings{.message_type = std::string(kEventPacket),
                         .polarity = static_cast<Polarity>(choice % 4)};
  settings.downsample = (choice & 4U) != 0 ? 7 : 1;
  if ((choice & 8U) != 0) {
    settings.region = Region{1, 2, 30, 20};
  }
  settings.refractory = (choice & 16U) != 0 ? 1'000'000 : 0;
  settings.width = static_cast<std::uint32_t>(event_channels(settings, kWidth, kHeight));
  return settings;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size < 2) {
    return 0;
  }
  const std::string_view encoding = kEncodings[data[0] % 4];
  const bool big_endian = (data[0] & 4U) != 0;
  const EventSettings settings = settings_of(data[1]);
  EventConversion conversion(settings, Dialect::ros1);
  EventPlayback playback(2 * kTick);
  std::uint64_t sequence = 0;
  std::size_t taken = 0;
  std::size_t sent = 0;
  TimeNs begin = 0;
  for (std::size_t at = 2; at + 2 <= size; begin += kTick) {
    const std::size_t count = std::min<std::size_t>(data[at], size - at - 2);
    sequence += 1 + data[at + 1] / 250U;
    const auto bytes = packet(encoding, big_endian, sequence, {data + at + 2, count});
    at += 2 + count;
    EventMessage message;
    try {
      conversion.convert(bytes, message);
    } catch (const ConfigurationError&) {
      return 0;  // an encoding that is unknown
    }
    for (const Spike& event : message.events) {
      need(event.channel >= 0 && static_cast<std::uint32_t>(event.channel) < settings.width);
      need(message.newest && event.time_ns <= *message.newest);
    }
    taken += message.events.size();
    const Interval interval{begin, begin + kTick};
    TimeNs before = begin;
    for (const Spike& spike : playback.step({&message, 1}, interval)) {
      need(interval.contains(spike.time_ns) && spike.time_ns >= before);
      before = spike.time_ns;
      ++sent;
    }
  }
  need(sent + playback.waiting() == taken);
  return 0;
}
