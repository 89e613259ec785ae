#include "spikeloop/messages/event_decoder.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cstring>

#include "header.hpp"
#include "spikeloop/core/code.hpp"
#include "spikeloop/core/error.hpp"

namespace spikeloop::messages {
namespace {

/// The highest 4 bits of a word of EVT 3.0.
enum class Word : std::uint8_t {
  row = 0x0,
  event = 0x2,
  vector_begin = 0x3,
  vector_12 = 0x4,
  vector_8 = 0x5,
  time_lower = 0x6,
  continued_4 = 0x7,
  time_upper = 0x8,
  padding = 0x9,  // sent by cameras of Lucid Vision Labs
  trigger = 0xa,
  others = 0xe,
  continued_12 = 0xf
};

/// The highest 4 bits of a word of EVT 2.0.
enum class LongWord : std::uint8_t {
  off = 0x0,
  on = 0x1,
  time_upper = 0x8,
  trigger = 0xa,
  others = 0xe,
  continued = 0xf
};

constexpr std::uint32_t kSidePixels = 2048;            // 11 bits
constexpr std::uint32_t kHalfTime = 4096;              // 12 bits
constexpr std::uint32_t kUpperTimeOfEvt2 = 1U << 28U;  // 28 bits
constexpr TimeNs kMicrosecond = 1000;

void check_camera(const EventPacket& packet, std::uint32_t most, std::size_t word) {
  if (packet.width == 0 || packet.height == 0 || packet.width > most || packet.height > most) {
    throw TransportError(
        with_code(Code::damaged_message,
                  "its camera has {} x {} pixels; the driver must set width and height, at most "
                  "{} each with {}",
                  packet.width, packet.height, most, packet.encoding));
  }
  if (packet.events.size() % word != 0) {
    throw TransportError(with_code(Code::damaged_message,
                                   "its {} bytes of events are no whole number of {} each, as {} "
                                   "has them",
                                   packet.events.size(), word, packet.encoding));
  }
}

}  // namespace

EventPacket read_event_packet(Dialect dialect, std::span<const std::byte> message) {
  return with_reader(dialect, message, [&](auto& reader) {
    skip_header(reader, dialect);
    EventPacket packet;
    packet.height = read_uint32(reader);
    packet.width = read_uint32(reader);
    packet.sequence = read_uint64(reader);
    packet.time_base = read_uint64(reader);
    packet.encoding = reader.text();
    packet.big_endian = reader.number(Primitive::boolean) != 0;
    packet.events = read_bytes(reader);
    return packet;
  });
}

void EventDecoder::decode(const EventPacket& packet, std::vector<CameraEvent>& events) {
  events.clear();
  if (packet.encoding == "mono") {
    decode_mono(packet, events);
    return;
  }
  const bool evt2 = packet.encoding == "evt2";
  if (!evt2 && packet.encoding != "evt3") {
    throw ConfigurationError(with_code(
        Code::image_encoding,
        "event packets with the encoding '{}' cannot be read; publish them as evt3, evt2 or mono",
        packet.encoding.substr(0, 40)));
  }
  if (evt2 != evt2_) {
    *this = {};
    evt2_ = evt2;
  }
  if (next_sequence_ && packet.sequence != *next_sequence_) {
    forget();
  }
  next_sequence_ = packet.sequence + 1;
  try {
    evt2 ? decode_evt2(packet, events) : decode_evt3(packet, events);
  } catch (const TransportError&) {
    forget();
    events.clear();
    throw;
  }
}

void EventDecoder::decode_mono(const EventPacket& packet, std::vector<CameraEvent>& events) const {
  constexpr std::uint32_t kMostPixels = 65'536;
  constexpr std::uint64_t kLatest = 1ULL << 62;  // of time_base: 146 years
  check_camera(packet, kMostPixels, sizeof(std::uint64_t));
  if (packet.time_base > kLatest) {
    throw TransportError(with_code(Code::damaged_message,
                                   "its time_base is {}, which is not a time in nanoseconds",
                                   packet.time_base));
  }
  events.reserve(packet.events.size() / sizeof(std::uint64_t));
  for (std::size_t at = 0; at < packet.events.size(); at += sizeof(std::uint64_t)) {
    const auto word = load<std::uint64_t>(packet.events.data() + at, packet.big_endian);
    events.push_back({static_cast<TimeNs>(packet.time_base + (word & 0xffff'ffff)),
                      static_cast<std::uint16_t>(word >> 32 & 0xffff),
                      static_cast<std::uint16_t>(word >> 48 & 0x7fff), (word >> 63) != 0});
  }
}

void EventDecoder::decode_evt2(const EventPacket& packet, std::vector<CameraEvent>& events) {
  check_camera(packet, kSidePixels, sizeof(std::uint32_t));
  for (std::size_t at = 0; at < packet.events.size(); at += sizeof(std::uint32_t)) {
    const auto word = load<std::uint32_t>(packet.events.data() + at, packet.big_endian);
    const auto type = static_cast<LongWord>(word >> 28U);
    switch (type) {
      case LongWord::off:
      case LongWord::on:
        if (upper_known_) {
          const TimeNs us = ((turns_ * kUpperTimeOfEvt2 + upper_) << 6U) + (word >> 22U & 0x3fU);
          events.push_back({kMicrosecond * us, static_cast<std::uint16_t>(word >> 11U & 0x7ffU),
                            static_cast<std::uint16_t>(word & 0x7ffU), type == LongWord::on});
        }
        break;
      case LongWord::time_upper:
        take_upper_time(word & (kUpperTimeOfEvt2 - 1), kUpperTimeOfEvt2);
        break;
      case LongWord::trigger:
      case LongWord::others:
      case LongWord::continued:
        break;
      default:
        throw TransportError(
            with_code(Code::damaged_message,
                      "word {} of its events is {:#010x}, and EVT 2.0 has none of this type",
                      at / sizeof(std::uint32_t), word));
    }
  }
}

void EventDecoder::decode_evt3(const EventPacket& packet, std::vector<CameraEvent>& events) {
  check_camera(packet, kSidePixels, sizeof(std::uint16_t));
  for (std::size_t at = 0; at < packet.events.size(); at += sizeof(std::uint16_t)) {
    const auto word = load<std::uint16_t>(packet.events.data() + at, packet.big_endian);
    const std::uint32_t rest = word & 0xfffU;
    const std::uint32_t place = rest & 0x7ffU;
    switch (static_cast<Word>(word >> 12)) {
      case Word::row:
        row_ = place;
        row_known_ = true;
        break;
      case Word::event:
        if (time_known_ && row_known_) {
          events.push_back({time(), static_cast<std::uint16_t>(place),
                            static_cast<std::uint16_t>(row_), (rest & 0x800U) != 0});
        }
        break;
      case Word::vector_begin:
        column_ = place;
        on_ = (rest & 0x800U) != 0;
        column_known_ = true;
        break;
      case Word::vector_12:
        take_vector(rest, 12, events);
        break;
      case Word::vector_8:
        take_vector(rest & 0xffU, 8, events);
        break;
      case Word::time_lower:
        lower_ = rest;
        time_known_ = upper_known_;
        break;
      case Word::time_upper:
        take_upper_time(rest, kHalfTime);
        break;
      case Word::padding:
      case Word::trigger:
      case Word::others:
      case Word::continued_4:
      case Word::continued_12:
        break;
      default:
        throw TransportError(
            with_code(Code::damaged_message,
                      "word {} of its events is {:#06x}, and EVT 3.0 has none of this type",
                      at / sizeof(std::uint16_t), word));
    }
  }
}

/// Beyond column 2047 there is nothing that a word could name.
void EventDecoder::take_vector(std::uint32_t bits, std::uint32_t count,
                               std::vector<CameraEvent>& events) {
  if (time_known_ && row_known_ && column_known_) {
    for (; bits != 0; bits &= bits - 1) {
      const std::uint32_t x = column_ + static_cast<std::uint32_t>(std::countr_zero(bits));
      events.push_back(
          {time(), static_cast<std::uint16_t>(x), static_cast<std::uint16_t>(row_), on_});
    }
  }
  column_ = std::min(column_ + count, kSidePixels);
}

/// Cameras send the upper half again and again, now and then a little out of order.
/// @param turn where it begins again with 0
void EventDecoder::take_upper_time(std::uint32_t upper, std::uint32_t turn) {
  if (upper + turn / 2 < upper_) {
    ++turns_;
  } else if (upper > upper_ + turn / 2 && turns_ > 0) {
    --turns_;
  }
  if (upper != upper_) {
    lower_ = 0;  // the word that says it comes next; the old one would be ahead of time
  }
  upper_ = upper;
  upper_known_ = true;
}

void EventDecoder::forget() {
  upper_known_ = false;
  time_known_ = false;
  row_known_ = false;
  column_known_ = false;
}

TimeNs EventDecoder::time() const {
  return kMicrosecond * ((turns_ * kHalfTime + static_cast<TimeNs>(upper_)) * kHalfTime +
                         static_cast<TimeNs>(lower_));
}

}  // namespace spikeloop::messages
