#include "spikeloop/messages/event_conversion.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <map>
#include <random>
#include <stdexcept>

#include "event_message.hpp"
#include "tests/support/error_of.hpp"

namespace event_conversion_test {
namespace {

using spikeloop::test::Fault;
using namespace spikeloop;
using namespace spikeloop::messages;
using test::error_of;
using test::event_message;
using test::RawEvent;
using testing::ElementsAre;
using testing::HasSubstr;

std::vector<int> channels_of(EventConversion& conversion, const std::vector<std::byte>& bytes) {
  EventMessage message;
  EXPECT_TRUE(conversion.convert(bytes, message));
  std::vector<int> channels;
  for (const Spike& event : message.events) {
    channels.push_back(event.channel);
  }
  return channels;
}

/// A brighter and a darker event of pixels (0, 0), (4, 0), (0, 1) and (4, 2) of 5 x 3.
std::vector<std::byte> corners() {
  std::vector<RawEvent> events;
  std::uint32_t nanoseconds = 0;
  for (const auto& [x, y] : {std::pair{0, 0}, {4, 0}, {0, 1}, {4, 2}}) {
    for (const bool on : {true, false}) {
      events.push_back(
          {static_cast<std::uint16_t>(x), static_cast<std::uint16_t>(y), 2, nanoseconds++, on});
    }
  }
  return event_message(5, 3, events);
}

TEST(EventConversion, a_channel_a_pixel) {
  EventConversion both({.width = 15}, Dialect::ros1);
  EventMessage message;
  ASSERT_TRUE(both.convert(corners(), message));
  ASSERT_EQ(message.events.size(), 8u);
  EXPECT_EQ(message.events[0].time_ns, 2'000'000'000);
  EXPECT_EQ(message.events[7].time_ns, 2'000'000'007);
  EXPECT_EQ(message.newest, 2'000'000'007);
  EXPECT_THAT(channels_of(both, corners()), ElementsAre(0, 0, 4, 4, 5, 5, 14, 14));
  EXPECT_EQ(both.counts().events, 16u);
  EXPECT_EQ(both.counts().left_out, 0u);
}

TEST(EventConversion, polarities) {
  EventConversion on({.polarity = Polarity::on, .width = 15}, Dialect::ros1);
  EXPECT_THAT(channels_of(on, corners()), ElementsAre(0, 4, 5, 14));
  EXPECT_EQ(on.counts().left_out, 4u);
  EventMessage message;
  EventConversion off({.polarity = Polarity::off, .width = 15}, Dialect::ros1);
  ASSERT_TRUE(off.convert(corners(), message));
  EXPECT_EQ(message.events[0].time_ns, 2'000'000'001);
  EXPECT_EQ(message.events.size(), 4u);
  EventConversion split({.polarity = Polarity::split, .width = 30}, Dialect::ros1);
  EXPECT_THAT(channels_of(split, corners()), ElementsAre(0, 15, 4, 19, 5, 20, 14, 29));
}

TEST(EventConversion, the_stamp_of_an_event_that_is_left_out_counts) {
  EventConversion on({.polarity = Polarity::on, .width = 15}, Dialect::ros1);
  EventMessage message;
  ASSERT_TRUE(on.convert(corners(), message));
  EXPECT_EQ(message.newest, 2'000'000'007);
  ASSERT_TRUE(on.convert(event_message(5, 3, {}), message));
  EXPECT_EQ(message.newest, std::nullopt);
}

TEST(EventConversion, blocks_at_the_rim_may_be_smaller) {
  EventConversion halved({.downsample = 2, .width = 6}, Dialect::ros1);
  EXPECT_THAT(channels_of(halved, corners()), ElementsAre(0, 0, 2, 2, 0, 0, 5, 5));
  EventConversion split({.polarity = Polarity::split, .downsample = 2, .width = 12}, Dialect::ros1);
  EXPECT_THAT(channels_of(split, corners()), ElementsAre(0, 6, 2, 8, 0, 6, 5, 11));
  EventConversion whole({.downsample = 8, .width = 1}, Dialect::ros1);
  EXPECT_THAT(channels_of(whole, corners()), ElementsAre(0, 0, 0, 0, 0, 0, 0, 0));
}

TEST(EventConversion, a_region_has_channels_of_its_own) {
  EventConversion region({.region = Region{3, 0, 2, 3}, .width = 6}, Dialect::ros1);
  EXPECT_THAT(channels_of(region, corners()), ElementsAre(1, 1, 5, 5));
  EXPECT_EQ(region.counts().left_out, 4u);
  EventConversion blocks(
      {.polarity = Polarity::split, .downsample = 2, .region = Region{2, 1, 3, 2}, .width = 4},
      Dialect::ros1);
  EXPECT_THAT(channels_of(blocks, corners()), ElementsAre(1, 3));
}

/// Every pixel of every camera, against the definition.
TEST(EventConversion, agrees_with_its_definition) {
  std::mt19937 random(1);
  for (int round = 0; round < 60; ++round) {
    const auto w = static_cast<std::uint32_t>(1 + random() % 12);
    const auto h = static_cast<std::uint32_t>(1 + random() % 12);
    const auto f = static_cast<std::uint32_t>(1 + random() % 4);
    Region r{static_cast<std::uint32_t>(random() % w), static_cast<std::uint32_t>(random() % h), 0,
             0};
    r.width = static_cast<std::uint32_t>(1 + random() % (w - r.x));
    r.height = static_cast<std::uint32_t>(1 + random() % (h - r.y));
    const std::uint32_t columns = (r.width + f - 1) / f;
    const std::uint32_t rows = (r.height + f - 1) / f;
    std::vector<RawEvent> events;
    std::vector<int> expected;
    for (std::uint32_t y = 0; y < h; ++y) {
      for (std::uint32_t x = 0; x < w; ++x) {
        const bool on = random() % 2 == 0;
        events.push_back({static_cast<std::uint16_t>(x), static_cast<std::uint16_t>(y), 1, 0, on});
        if (x >= r.x && x < r.x + r.width && y >= r.y && y < r.y + r.height) {
          expected.push_back(static_cast<int>((on ? 0 : rows * columns) + (y - r.y) / f * columns +
                                              (x - r.x) / f));
        }
      }
    }
    EventConversion conversion(
        {.polarity = Polarity::split, .downsample = f, .region = r, .width = 2 * rows * columns},
        Dialect::ros1);
    ASSERT_EQ(channels_of(conversion, event_message(w, h, events)), expected);
  }
}

TEST(EventConversion, a_channel_rests) {
  std::vector<RawEvent> events;
  for (const std::uint32_t microseconds : {0, 500, 999, 1000, 1999, 2500}) {
    events.push_back({0, 0, 1, 1000 * microseconds, true});
    events.push_back({1, 0, 1, 1000 * microseconds, true});
  }
  EventConversion conversion({.refractory = 1'000'000, .width = 2}, Dialect::ros1);
  EventMessage message;
  ASSERT_TRUE(conversion.convert(event_message(2, 1, events), message));
  std::map<int, std::vector<TimeNs>> times;
  for (const Spike& event : message.events) {
    times[event.channel].push_back(event.time_ns - kNsPerSecond);
  }
  EXPECT_THAT(times[0], ElementsAre(0, 1'000'000, 2'500'000));
  EXPECT_EQ(times[1], times[0]);
  EXPECT_EQ(conversion.counts().refractory, 6u);
  // The sensor's clock jumps back.
  const std::vector<RawEvent> again = {{0, 0, 0, 5, true}, {0, 0, 0, 6, true}};
  EXPECT_THAT(channels_of(conversion, event_message(2, 1, again)), ElementsAre(0));
}

TEST(EventConversion, the_camera_must_fit_the_port) {
  const Location place{"job.music", 9, 1};
  EventMessage message;
  EventConversion narrow({.width = 14, .where = place}, Dialect::ros1);
  EXPECT_THAT(error_of([&] { narrow.convert(corners(), message); }),
              Fault("job.music:9:1: a camera of 5 x 3 pixels makes 15 channels (polarity=both, "
                    "downsample=1) ... 14 ... [15] ... [SL0505]"));
  EventConversion wide({.polarity = Polarity::split, .downsample = 2, .width = 30}, Dialect::ros1);
  EXPECT_THAT(error_of([&] { wide.convert(corners(), message); }),
              Fault("a camera of 5 x 3 pixels makes 12 channels (polarity=split, downsample=2) ... "
                    "30 ... [12] ... [SL0505]"));
  EXPECT_THAT(error_of([&] {
                const EventConversion conversion(
                    {.region = Region{0, 0, 4, 2}, .width = 9, .where = place}, Dialect::ros1);
              }),
              Fault("job.music:9:1: a region of 4 x 2 pixels makes 8 channels (polarity=both, "
                    "downsample=1) ... 9 ... [8] ... [SL0505]"));
  EventConversion beyond({.region = Region{2, 0, 4, 2}, .width = 8}, Dialect::ros1);
  EXPECT_EQ(error_of([&] { beyond.convert(corners(), message); }),
            "roi=2,0,4,2 reaches beyond the camera, which has 5 x 3 pixels; write a region within "
            "it [SL0203]");
  EventConversion far({.region = Region{4294967295, 0, 4, 2}, .width = 8}, Dialect::ros1);
  EXPECT_THAT(error_of([&] { far.convert(corners(), message); }), HasSubstr("reaches beyond"));
  EventConversion fits({.width = 15}, Dialect::ros1);
  EXPECT_TRUE(fits.convert(corners(), message));
  EXPECT_THAT(error_of([&] { fits.convert(event_message(3, 3, {}), message); }),
              HasSubstr("a camera of 3 x 3 pixels makes 9 channels"))
      << "another camera on the topic";
}

TEST(EventConversion, what_cannot_be_read_is_left_out_and_told_once) {
  EventConversion conversion({.width = 15}, Dialect::ros1);
  auto bytes = corners();
  bytes.pop_back();
  EventMessage message;
  EXPECT_FALSE(conversion.convert(bytes, message));
  EXPECT_TRUE(message.events.empty());
  EXPECT_THAT(conversion.take_warning(),
              testing::StartsWith("a dvs_msgs/EventArray could not be read and is left out: "
                                  "message of "));
  EXPECT_FALSE(conversion.convert(bytes, message));
  EXPECT_EQ(conversion.take_warning(), "");
  EXPECT_EQ(conversion.counts().malformed, 2u);
  EXPECT_EQ(conversion.counts().messages, 2u);
}

TEST(EventConversion, pixels_that_the_camera_does_not_have) {
  EventConversion conversion({.width = 15}, Dialect::ros1);
  const std::vector<RawEvent> events = {{5, 0, 1, 0, true}, {0, 3, 1, 0, true}, {4, 2, 1, 0, true}};
  EXPECT_THAT(channels_of(conversion, event_message(5, 3, events)), ElementsAre(14));
  EXPECT_EQ(conversion.take_warning(),
            "2 events of a message lie outside the 5 x 3 pixels that it says its camera has; they "
            "are left out");
  EXPECT_EQ(conversion.counts().outside_camera, 2u);
  channels_of(conversion, event_message(5, 3, events));
  EXPECT_EQ(conversion.take_warning(), "");
}

TEST(EventConversion, names_of_polarities) {
  for (const char* name : {"both", "on", "off", "split"}) {
    EXPECT_STREQ(name_of(polarity_named(name)), name);
  }
  EXPECT_THROW(polarity_named("up"), std::logic_error);
}

}  // namespace
}  // namespace event_conversion_test
