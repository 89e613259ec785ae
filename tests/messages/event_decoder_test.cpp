#include "spikeloop/messages/event_decoder.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <random>

#include "spikeloop/core/error.hpp"
#include "tests/support/fault.hpp"

namespace event_decoder_test {
namespace {

using spikeloop::test::Fault;
using namespace spikeloop;
using namespace spikeloop::messages;
using testing::ElementsAre;
using testing::IsEmpty;

/// What the specification of EVT 3.0 says of the words, from the sender's side.
class Evt3Encoder {
 public:
  explicit Evt3Encoder(bool big_endian = false) : big_endian_(big_endian) {}

  void word(unsigned type, unsigned rest) {
    const unsigned all = type << 12 | rest;
    const auto low = static_cast<std::byte>(all & 0xff);
    const auto high = static_cast<std::byte>(all >> 8);
    bytes.push_back(big_endian_ ? high : low);
    bytes.push_back(big_endian_ ? low : high);
  }

  /// Time in microseconds since the sensor began.
  void time(std::uint64_t us) {
    if (const auto upper = static_cast<unsigned>(us / 4096 % 4096); upper != upper_) {
      word(0x8, upper);
      upper_ = upper;
      lower_ = 4096;
    }
    if (const auto lower = static_cast<unsigned>(us % 4096); lower != lower_) {
      word(0x6, lower);
      lower_ = lower;
    }
  }
  void row(unsigned y) {
    if (y != row_) {
      word(0x0, y);
      row_ = y;
    }
  }
  void event(std::uint64_t us, unsigned x, unsigned y, bool on) {
    time(us);
    row(y);
    word(0x2, x | (on ? 0x800U : 0U));
  }
  void vector(std::uint64_t us, unsigned x, unsigned y, bool on) {
    time(us);
    row(y);
    word(0x3, x | (on ? 0x800U : 0U));
  }

  std::vector<std::byte> bytes;

 private:
  bool big_endian_;
  unsigned upper_ = 4096;
  unsigned lower_ = 4096;
  unsigned row_ = 4096;
};

EventPacket evt3(const std::vector<std::byte>& bytes, std::uint64_t sequence = 0) {
  return {720, 1280, sequence, 0, "evt3", false, bytes};
}

using Event = std::tuple<TimeNs, int, int, bool>;

std::vector<Event> decoded(EventDecoder& decoder, const EventPacket& packet) {
  std::vector<CameraEvent> events;
  decoder.decode(packet, events);
  std::vector<Event> result;
  for (const CameraEvent& event : events) {
    result.emplace_back(event.stamp, event.x, event.y, event.on);
  }
  return result;
}

std::string error_of(const EventPacket& packet) {
  EventDecoder decoder;
  std::vector<CameraEvent> events(1);
  try {
    decoder.decode(packet, events);
  } catch (const Error& error) {
    EXPECT_TRUE(events.empty());
    return error.what();
  }
  return "no error";
}

TEST(EventDecoder, evt3_single_events) {
  Evt3Encoder camera;
  camera.event(5, 7, 3, true);
  camera.event(5, 8, 3, false);
  camera.event(4096 + 6, 1279, 719, true);
  EventDecoder decoder;
  EXPECT_THAT(decoded(decoder, evt3(camera.bytes)),
              ElementsAre(Event{5'000, 7, 3, true}, Event{5'000, 8, 3, false},
                          Event{4'102'000, 1279, 719, true}));
}

// 12 + 12 + 8 pixels: how the sensor sends 32 of them.
TEST(EventDecoder, evt3_vectors_go_on_where_the_one_before_ended) {
  Evt3Encoder camera;
  camera.vector(1, 100, 9, true);
  camera.word(0x4, 0x801);
  camera.word(0x4, 0x002);
  camera.word(0x5, 0xf81);  // bits 8 to 11 mean nothing
  EventDecoder decoder;
  EXPECT_THAT(decoded(decoder, evt3(camera.bytes)),
              ElementsAre(Event{1'000, 100, 9, true}, Event{1'000, 111, 9, true},
                          Event{1'000, 113, 9, true}, Event{1'000, 124, 9, true},
                          Event{1'000, 131, 9, true}));
}

TEST(EventDecoder, evt3_keeps_its_state_from_packet_to_packet) {
  Evt3Encoder camera;
  camera.vector(77, 40, 5, false);
  EventDecoder decoder;
  EXPECT_THAT(decoded(decoder, evt3(camera.bytes, 10)), IsEmpty());
  camera.bytes.clear();
  camera.word(0x5, 0x1);
  camera.event(77, 2, 5, true);  // neither time nor row are said again
  EXPECT_THAT(decoded(decoder, evt3(camera.bytes, 11)),
              ElementsAre(Event{77'000, 40, 5, false}, Event{77'000, 2, 5, true}));
}

TEST(EventDecoder, evt3_decodes_nothing_before_time_and_row) {
  Evt3Encoder camera;
  camera.word(0x2, 1);
  camera.word(0x6, 9);  // the lower half alone is not a time
  camera.word(0x0, 4);
  camera.word(0x2, 2);
  camera.word(0x5, 0xff);  // a vector that begins nowhere
  camera.word(0x8, 1);
  camera.word(0x2, 3);
  camera.word(0x6, 9);
  camera.word(0x5, 0xff);
  camera.word(0x2, 4);
  EventDecoder decoder;
  EXPECT_THAT(decoded(decoder, evt3(camera.bytes)), ElementsAre(Event{4'105'000, 4, 4, false}));
}

TEST(EventDecoder, evt3_waits_for_time_and_row_after_a_loss) {
  Evt3Encoder camera;
  camera.event(5'000, 7, 3, true);
  EventDecoder decoder;
  EXPECT_EQ(decoded(decoder, evt3(camera.bytes, 3)).size(), 1u);
  camera.bytes.clear();
  camera.event(5'001, 8, 3, true);
  EXPECT_THAT(decoded(decoder, evt3(camera.bytes, 5)), IsEmpty());
  Evt3Encoder again;
  again.event(6'000, 8, 4, true);
  EXPECT_THAT(decoded(decoder, evt3(again.bytes, 6)), ElementsAre(Event{6'000'000, 8, 4, true}));
}

TEST(EventDecoder, evt3_time_goes_on_when_24_bits_are_over) {
  constexpr std::uint64_t kTurn = 1ULL << 24;
  Evt3Encoder camera;
  std::vector<Event> expected;
  for (std::uint64_t us = 1'000; us < 5 * kTurn; us += 3'000'017) {
    camera.event(us, 1, 1, true);
    expected.emplace_back(static_cast<TimeNs>(1'000 * us), 1, 1, true);
  }
  EventDecoder decoder;
  EXPECT_EQ(decoded(decoder, evt3(camera.bytes)), expected);
}

TEST(EventDecoder, evt3_upper_time_that_comes_late_is_no_turn) {
  Evt3Encoder camera;
  for (const std::uint64_t upper : {4095ULL, 4096ULL, 4095ULL, 4096ULL, 4097ULL, 4096ULL}) {
    camera.event(upper << 12, 1, 1, true);
  }
  EventDecoder decoder;
  std::vector<TimeNs> turns;
  for (const Event& event : decoded(decoder, evt3(camera.bytes))) {
    turns.push_back(std::get<0>(event) / 1000 >> 12);
  }
  EXPECT_THAT(turns, ElementsAre(4095, 4096, 4095, 4096, 4097, 4096));
}

TEST(EventDecoder, evt3_words_of_other_use_are_passed_over) {
  Evt3Encoder camera;
  camera.event(1, 1, 1, true);
  for (const unsigned type : {0x7U, 0x9U, 0xaU, 0xeU, 0xfU}) {
    camera.word(type, 0xfff);
  }
  camera.event(1, 2, 1, true);
  EventDecoder decoder;
  EXPECT_EQ(decoded(decoder, evt3(camera.bytes)).size(), 2u);
}

TEST(EventDecoder, evt3_big_endian) {
  Evt3Encoder camera(true);
  camera.event(123'456, 300, 200, true);
  EventPacket packet = evt3(camera.bytes);
  packet.big_endian = true;
  EventDecoder decoder;
  EXPECT_THAT(decoded(decoder, packet), ElementsAre(Event{123'456'000, 300, 200, true}));
}

/// Bursts at random places and times, as single events or vectors, cut into packets anywhere
/// between words.
TEST(EventDecoder, evt3_random_streams) {
  for (unsigned seed = 0; seed < 50; ++seed) {
    std::mt19937_64 random(seed);
    const auto up_to = [&](std::uint64_t most) { return random() % (most + 1); };
    Evt3Encoder camera;
    std::vector<Event> expected;
    std::uint64_t us = up_to(10'000'000);  // the first burst is within the first turn
    for (int burst = 0; burst < 200; ++burst) {
      us += up_to(burst % 10 == 0 ? 6'000'000 : 300);
      const auto y = static_cast<int>(up_to(719));
      auto x = static_cast<int>(up_to(1200));
      const bool on = up_to(1) != 0;
      const auto stamp = static_cast<TimeNs>(1'000 * us);
      if (up_to(2) != 0) {
        camera.event(us, static_cast<unsigned>(x), static_cast<unsigned>(y), on);
        expected.emplace_back(stamp, x, y, on);
        continue;
      }
      camera.vector(us, static_cast<unsigned>(x), static_cast<unsigned>(y), on);
      for (const int count : {12, 12, 8}) {
        const auto bits = static_cast<unsigned>(up_to((1U << count) - 1));
        camera.word(count == 12 ? 0x4 : 0x5, bits);
        for (int i = 0; i < count; ++i) {
          if ((bits >> i & 1) != 0) {
            expected.emplace_back(stamp, x + i, y, on);
          }
        }
        x += count;
      }
    }
    EventDecoder decoder;
    std::vector<Event> all;
    std::uint64_t sequence = 0;
    for (std::size_t at = 0; at < camera.bytes.size();) {
      const std::size_t count = std::min<std::size_t>(2 * up_to(200), camera.bytes.size() - at);
      const std::vector<std::byte> part(
          camera.bytes.begin() + static_cast<std::ptrdiff_t>(at),
          camera.bytes.begin() + static_cast<std::ptrdiff_t>(at + count));
      const auto events = decoded(decoder, evt3(part, sequence++));
      all.insert(all.end(), events.begin(), events.end());
      at += count;
    }
    ASSERT_EQ(all, expected) << "seed " << seed;
  }
}

/// What the specification of EVT 2.0 says of the words, from the sender's side.
class Evt2Encoder {
 public:
  void word(std::uint64_t type, std::uint64_t rest) {
    for (int i = 0; i < 4; ++i) {
      bytes.push_back(static_cast<std::byte>((type << 28 | rest) >> (8 * i) & 0xff));
    }
  }
  void time(std::uint64_t us) { word(0x8, us / 64 % (1ULL << 28)); }
  void event(std::uint64_t us, std::uint64_t x, std::uint64_t y, bool on) {
    if (us / 64 != upper_) {
      upper_ = us / 64;
      time(us);
    }
    word(on ? 0x1 : 0x0, us % 64 << 22 | x << 11 | y);
  }

  std::vector<std::byte> bytes;

 private:
  std::uint64_t upper_ = ~0ULL;
};

EventPacket evt2(const std::vector<std::byte>& bytes, std::uint64_t sequence = 0) {
  return {720, 1280, sequence, 0, "evt2", false, bytes};
}

TEST(EventDecoder, evt2_single_events) {
  Evt2Encoder camera;
  camera.event(5, 7, 3, true);
  camera.event(63, 8, 3, false);
  camera.event(64, 1279, 719, true);
  camera.event(12'345'678'901, 2047, 2047, false);
  EventDecoder decoder;
  EXPECT_THAT(
      decoded(decoder, evt2(camera.bytes)),
      ElementsAre(Event{5'000, 7, 3, true}, Event{63'000, 8, 3, false},
                  Event{64'000, 1279, 719, true}, Event{12'345'678'901'000, 2047, 2047, false}));
}

TEST(EventDecoder, evt2_keeps_its_time_from_packet_to_packet_and_loses_it_with_one) {
  Evt2Encoder camera;
  camera.word(0x1, 9);  // no time has come
  camera.event(1'000, 1, 2, true);
  EventDecoder decoder;
  EXPECT_THAT(decoded(decoder, evt2(camera.bytes, 4)), ElementsAre(Event{1'000'000, 1, 2, true}));
  camera.bytes.clear();
  camera.event(1'001, 3, 4, false);
  EXPECT_THAT(decoded(decoder, evt2(camera.bytes, 5)), ElementsAre(Event{1'001'000, 3, 4, false}));
  EXPECT_THAT(decoded(decoder, evt2(camera.bytes, 7)), IsEmpty());
  Evt2Encoder again;
  again.event(1'003, 3, 4, false);
  EXPECT_THAT(decoded(decoder, evt2(again.bytes, 8)), ElementsAre(Event{1'003'000, 3, 4, false}));
}

TEST(EventDecoder, evt2_time_goes_on_when_34_bits_are_over) {
  Evt2Encoder camera;
  std::vector<Event> expected;
  for (std::uint64_t us = 77; us < 3 * (1ULL << 34); us += 3'000'000'017) {
    camera.event(us, 1, 1, true);
    expected.emplace_back(static_cast<TimeNs>(1'000 * us), 1, 1, true);
  }
  EventDecoder decoder;
  EXPECT_EQ(decoded(decoder, evt2(camera.bytes)), expected);
}

TEST(EventDecoder, evt2_words_of_other_use_are_passed_over) {
  Evt2Encoder camera;
  camera.event(1, 1, 1, true);
  for (const unsigned type : {0xaU, 0xeU, 0xfU}) {
    camera.word(type, 0xfff'ffff);
  }
  camera.event(1, 2, 1, true);
  EventDecoder decoder;
  EXPECT_EQ(decoded(decoder, evt2(camera.bytes)).size(), 2u);
}

TEST(EventDecoder, evt2_big_endian) {
  const std::vector<std::byte> bytes{std::byte{0x80}, std::byte{0},    std::byte{0},
                                     std::byte{2},    std::byte{0x10}, std::byte{0x40},
                                     std::byte{0x28}, std::byte{7}};
  EventPacket packet = evt2(bytes);
  packet.big_endian = true;
  EventDecoder decoder;
  EXPECT_THAT(decoded(decoder, packet), ElementsAre(Event{129'000, 5, 7, true}));
}

TEST(EventDecoder, another_encoding_begins_anew) {
  EventDecoder decoder;
  Evt2Encoder late;
  late.event(5'000'000'000, 1, 1, true);
  EXPECT_EQ(decoded(decoder, evt2(late.bytes, 1)).size(), 1u);
  Evt3Encoder camera;
  camera.event(5, 7, 3, true);
  EXPECT_THAT(decoded(decoder, evt3(camera.bytes, 2)), ElementsAre(Event{5'000, 7, 3, true}));
  const Evt2Encoder nothing;
  EXPECT_THAT(decoded(decoder, evt2(nothing.bytes, 3)), IsEmpty());
  const std::vector<std::byte> event(4);
  EXPECT_THAT(decoded(decoder, evt2(event, 4)), IsEmpty()) << "the time was that of evt3";
}

/// Bursts at random places and times, cut into packets anywhere between words.
TEST(EventDecoder, evt2_random_streams) {
  for (unsigned seed = 0; seed < 50; ++seed) {
    std::mt19937_64 random(seed);
    Evt2Encoder camera;
    std::vector<Event> expected;
    std::uint64_t us = random() % (1ULL << 33);
    for (int i = 0; i < 1'000; ++i) {
      us += random() % (i % 50 == 0 ? 1ULL << 33 : 100);
      const auto x = static_cast<int>(random() % 1280);
      const auto y = static_cast<int>(random() % 720);
      const bool on = random() % 2 == 0;
      camera.event(us, static_cast<std::uint64_t>(x), static_cast<std::uint64_t>(y), on);
      expected.emplace_back(static_cast<TimeNs>(1'000 * us), x, y, on);
    }
    EventDecoder decoder;
    std::vector<Event> all;
    std::uint64_t sequence = 0;
    for (std::size_t at = 0; at < camera.bytes.size();) {
      const std::size_t count =
          std::min<std::size_t>(4 * (random() % 200), camera.bytes.size() - at);
      const std::vector<std::byte> part(
          camera.bytes.begin() + static_cast<std::ptrdiff_t>(at),
          camera.bytes.begin() + static_cast<std::ptrdiff_t>(at + count));
      const auto events = decoded(decoder, evt2(part, sequence++));
      all.insert(all.end(), events.begin(), events.end());
      at += count;
    }
    ASSERT_EQ(all, expected) << "seed " << seed;
  }
}

TEST(EventDecoder, mono) {
  std::vector<std::byte> bytes;
  const auto put = [&](std::uint64_t dt, std::uint64_t x, std::uint64_t y, bool on) {
    const std::uint64_t word = dt + (x << 32) + (y << 48) + (std::uint64_t{on} << 63);
    for (int i = 0; i < 8; ++i) {
      bytes.push_back(static_cast<std::byte>(word >> (8 * i)));
    }
  };
  put(5, 3, 2, true);
  put(0xffff'ffff, 65'535, 32'767, false);
  EventPacket packet{480, 640, 0, 1'000'000'000'000, "mono", false, bytes};
  EventDecoder decoder;
  EXPECT_THAT(decoded(decoder, packet),
              ElementsAre(Event{1'000'000'000'005, 3, 2, true},
                          Event{1'004'294'967'295, 65'535, 32'767, false}));
  packet.time_base = 0;
  EXPECT_EQ(std::get<0>(decoded(decoder, packet).front()), 5);
  std::vector<std::byte> turned(bytes.rbegin(), bytes.rend());
  packet.events = turned;
  packet.big_endian = true;
  EXPECT_EQ(std::get<1>(decoded(decoder, packet).back()), 3);
}

TEST(EventDecoder, what_is_wrong_is_said) {
  const std::vector<std::byte> three(3);
  EXPECT_THAT(
      error_of({480, 640, 0, 0, "libcaer", false, {}}),
      Fault("event packets with the encoding 'libcaer' cannot be read; publish them as evt3, evt2 "
            "or mono [SL0511]"));
  EXPECT_THAT(
      error_of({480, 640, 0, 0, "evt3", false, three}),
      Fault("its 3 bytes of events are no whole number of 2 each, as evt3 has them [SL0509]"));
  EXPECT_THAT(error_of({480, 640, 0, 0, "mono", false, three}),
              Fault("its 3 ... 8 each, as mono has them ... [SL0509]"));
  EXPECT_THAT(error_of({0, 640, 0, 0, "mono", false, {}}),
              Fault("... 640 x 0 pixels ... at most 65536 each with mono ... [SL0509]"));
  EXPECT_THAT(error_of({480, 2049, 0, 0, "evt3", false, {}}),
              Fault("... 2049 x 480 pixels ... at most 2048 each with evt3 ... [SL0509]"));
  EXPECT_THAT(
      error_of({480, 640, 0, ~0ULL, "mono", false, {}}),
      Fault("its time_base is 18446744073709551615, which is not a time in nanoseconds [SL0509]"));
  Evt3Encoder camera;
  camera.event(1, 1, 1, true);
  camera.word(0xd, 0x123);
  EXPECT_EQ(error_of(evt3(camera.bytes)),
            "word 4 of its events is 0xd123, and EVT 3.0 has none of this type [SL0509]");
}

TEST(EventDecoder, what_is_wrong_with_evt2_is_said) {
  const std::vector<std::byte> six(6);
  EXPECT_THAT(error_of(evt2(six)), Fault("its 6 ... 4 each, as evt2 has them ... [SL0509]"));
  EXPECT_THAT(error_of({2049, 640, 0, 0, "evt2", false, {}}),
              Fault("... 640 x 2049 pixels ... at most 2048 each with evt2 ... [SL0509]"));
  Evt2Encoder camera;
  camera.event(1, 1, 1, true);
  camera.word(0x4, 0x123);
  EXPECT_THAT(error_of(evt2(camera.bytes)),
              Fault("word 2 ... 0x40000123, and EVT 2.0 ... [SL0509]"));
}

TEST(EventDecoder, garbage_is_decoded_or_refused) {
  std::mt19937_64 random(7);
  EventDecoder decoder;
  std::vector<CameraEvent> events;
  std::size_t taken = 0;
  for (std::uint64_t packet = 0; packet < 2'000; ++packet) {
    std::vector<std::byte> bytes(2 * (random() % 100));
    for (std::byte& each : bytes) {
      each = static_cast<std::byte>(random());
    }
    if (packet % 2 == 0) {  // of known types alone, so that whole packets are taken, too
      constexpr unsigned kTypes[] = {0x0, 0x2, 0x3, 0x4, 0x5, 0x6, 0x8};
      for (std::size_t i = 1; i < bytes.size(); i += 2) {
        bytes[i] = (bytes[i] & std::byte{0xf}) | static_cast<std::byte>(kTypes[random() % 7] << 4);
      }
    }
    try {
      decoder.decode(evt3(bytes, packet), events);
      for (const CameraEvent& event : events) {
        ASSERT_LT(event.x, 2048 + 12);
        ASSERT_LT(event.y, 2048);
        ASSERT_GE(event.stamp, 0);
      }
      taken += events.size();
    } catch (const TransportError&) {
      ASSERT_THAT(events, IsEmpty());
    }
  }
  EXPECT_GT(taken, 0u);
}

}  // namespace
}  // namespace event_decoder_test
