// event_camera_msgs/EventPacket as channels, in both dialects.
#include "spikeloop/messages/event_decoder.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "spikeloop/core/error.hpp"
#include "spikeloop/messages/catalog.hpp"
#include "spikeloop/messages/event_conversion.hpp"
#include "spikeloop/messages/message_writer.hpp"

namespace event_packet_test {
namespace {

using namespace spikeloop;
using namespace spikeloop::messages;
using testing::ElementsAre;

class EventPackets : public testing::TestWithParam<Dialect> {
 protected:
  static std::vector<std::byte> packet(const std::string& encoding,
                                       const std::vector<double>& events, double sequence = 0,
                                       double time_base = 0) {
    const std::string frame = "camera";
    const std::vector<double> numbers[] = {{3}, {5}, {sequence}, {time_base}};
    std::vector<std::byte> bytes;
    MessageWriter(Catalog::builtin(GetParam()), kEventPacket,
                  {"header.frame_id", "encoding", "height", "width", "seq", "time_base", "events"})
        .write(std::vector<FieldValue>{{{}, frame},
                                       {{}, encoding},
                                       {numbers[0], {}},
                                       {numbers[1], {}},
                                       {numbers[2], {}},
                                       {numbers[3], {}},
                                       {events, {}}},
               bytes);
    return bytes;
  }

  static EventConversion conversion(Polarity polarity, std::uint32_t width) {
    return {{.message_type = std::string(kEventPacket), .polarity = polarity, .width = width},
            GetParam()};
  }
};

INSTANTIATE_TEST_SUITE_P(Dialects, EventPackets, testing::Values(Dialect::ros1, Dialect::ros2),
                         [](const auto& dialect) {
                           return dialect.param == Dialect::ros1 ? "ros1" : "ros2";
                         });

/// Time 1 + 2 * 4096 us, row 2, a darker event at x = 4, a brighter vector at 0 and 3.
const std::vector<double> kEvt3{0x02, 0x80, 0x01, 0x60, 0x02, 0x00,
                                0x04, 0x20, 0x00, 0x38, 0x09, 0x50};

TEST_P(EventPackets, evt3_becomes_channels) {
  EventConversion split = conversion(Polarity::split, 30);
  EventMessage message;
  ASSERT_TRUE(split.convert(packet("evt3", kEvt3), message));
  ASSERT_EQ(message.events.size(), 3u);
  EXPECT_EQ(message.events[0].channel, 15 + 2 * 5 + 4);
  EXPECT_EQ(message.events[1].channel, 2 * 5);
  EXPECT_EQ(message.events[2].channel, 2 * 5 + 3);
  EXPECT_EQ(message.newest, 8'193'000);
  // The time and the row go on in the next packet.
  ASSERT_TRUE(split.convert(packet("evt3", {0x01, 0x20}, 1), message));
  ASSERT_EQ(message.events.size(), 1u);
  EXPECT_EQ(message.events[0].time_ns, 8'193'000);
  EXPECT_EQ(split.counts().events, 4u);
}

TEST_P(EventPackets, mono_becomes_channels) {
  // x = 3, y = 1, brighter, 7 ns after the base, which a double could not tell from its neighbours.
  EventConversion both = conversion(Polarity::both, 15);
  EventMessage message;
  ASSERT_TRUE(both.convert(packet("mono", {7, 0, 0, 0, 3, 0, 1, 0x80}, 0, 1e18), message));
  ASSERT_EQ(message.events.size(), 1u);
  EXPECT_EQ(message.events[0].channel, 5 + 3);
  EXPECT_EQ(message.newest, 1'000'000'000'000'000'007);
}

TEST_P(EventPackets, events_outside_of_the_camera_are_counted) {
  EventConversion both = conversion(Polarity::both, 15);
  EventMessage message;
  ASSERT_TRUE(both.convert(packet("mono", {0, 0, 0, 0, 5, 0, 0, 0}), message));
  EXPECT_TRUE(message.events.empty());
  EXPECT_EQ(both.counts().outside_camera, 1u);
}

TEST_P(EventPackets, damaged_ones_are_counted) {
  EventConversion both = conversion(Polarity::both, 15);
  const auto good = packet("evt3", kEvt3);
  EventMessage message;
  for (std::size_t size = 0; size < good.size(); ++size) {
    ASSERT_FALSE(both.convert(std::span(good).first(size), message)) << size;
  }
  EXPECT_EQ(both.counts().malformed, good.size());
  EXPECT_TRUE(both.convert(good, message));
}

TEST(EventPacket, other_types_have_no_events) {
  try {
    EventConversion({.message_type = "event_camera_msgs/EventPack", .width = 15}, Dialect::ros2);
    FAIL();
  } catch (const ConfigurationError& error) {
    EXPECT_STREQ(error.what(),
                 "message type 'event_camera_msgs/EventPack' has no events of a camera; did you "
                 "mean 'event_camera_msgs/EventPacket'? [SL0504]");
  }
}

}  // namespace
}  // namespace event_packet_test
