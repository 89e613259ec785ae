#include "spikeloop/messages/event_array.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

#include "event_message.hpp"
#include "reference_cdr.hpp"
#include "spikeloop/core/error.hpp"
#include "spikeloop/messages/catalog.hpp"
#include "spikeloop/messages/message_writer.hpp"

namespace event_array_test {
namespace {

using namespace spikeloop;
using namespace spikeloop::messages;
using test::event_message;
using test::RawEvent;
using testing::HasSubstr;

const std::vector<RawEvent> kEvents = {{3, 5, 1'700'000'000, 999'999'999, true},
                                       {345, 259, 4'294'967'295, 1, false}};

std::string error_of(std::span<const std::byte> message) {
  try {
    const EventArray array(message, Dialect::ros1);
  } catch (const TransportError& error) {
    return error.what();
  }
  return "no error";
}

TEST(EventArray, reads_every_field) {
  const auto bytes = event_message(346, 260, kEvents);
  const EventArray array(bytes, Dialect::ros1);
  EXPECT_EQ(array.width(), 346u);
  EXPECT_EQ(array.height(), 260u);
  ASSERT_EQ(array.size(), 2u);
  EXPECT_EQ(array[0].x, 3);
  EXPECT_EQ(array[0].y, 5);
  EXPECT_EQ(array[0].stamp, 1'700'000'000'999'999'999);
  EXPECT_TRUE(array[0].on);
  EXPECT_EQ(array[1].x, 345);
  EXPECT_EQ(array[1].y, 259);
  EXPECT_EQ(array[1].stamp, 4'294'967'295'000'000'001);
  EXPECT_FALSE(array[1].on);
  const auto empty = event_message(346, 260, {}, "");
  EXPECT_EQ(EventArray(empty, Dialect::ros1).size(), 0u);
}

// dvs_msgs is not in Debian; these are the sums of its version 0.0.0, which drivers use.
TEST(EventArray, definitions_have_the_drivers_sums) {
  EXPECT_EQ(Catalog::builtin(Dialect::ros1).md5("dvs_msgs/EventArray"),
            "5e8beee5a6c107e504c2e78903c224b8");
  EXPECT_EQ(Catalog::builtin(Dialect::ros1).md5("dvs_msgs/Event"),
            "40d339b261445b8ce9a6fef01267cd5d");
  EXPECT_EQ(Catalog::builtin(Dialect::ros1).layout("dvs_msgs/Event")->bytes,
            EventArray::kEventBytes);
}

TEST(EventArray, reads_what_the_codec_writes) {
  const MessageWriter writer(Catalog::builtin(Dialect::ros1), "dvs_msgs/EventArray",
                             {"header.frame_id", "height", "width", "events[1].x", "events[1].y",
                              "events[1].ts.secs", "events[1].ts.nsecs", "events[1].polarity"});
  const double numbers[] = {260, 346, 11, 12, 13, 14, 1};
  std::vector<FieldValue> values = {{{}, "camera"}};
  for (const double& number : numbers) {
    values.push_back({{&number, 1}, {}});
  }
  std::vector<std::byte> bytes;
  writer.write(values, bytes);
  const EventArray array(bytes, Dialect::ros1);
  ASSERT_EQ(array.size(), 2u);
  EXPECT_EQ(array.width(), 346u);
  EXPECT_EQ(array[0].stamp, 0);
  EXPECT_EQ(array[1].x, 11);
  EXPECT_EQ(array[1].y, 12);
  EXPECT_EQ(array[1].stamp, 13'000'000'014);
  EXPECT_TRUE(array[1].on);
}

TEST(EventArray, truncated_and_overlong_messages_are_refused) {
  auto bytes = event_message(346, 260, kEvents);
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    // A copy of exactly this size: its end is the end of the allocation.
    const std::vector<std::byte> cut(bytes.begin(),
                                     bytes.begin() + static_cast<std::ptrdiff_t>(size));
    EXPECT_THAT(error_of(cut), HasSubstr("is shorter than its type says")) << size;
  }
  bytes.resize(bytes.size() + 3);
  EXPECT_EQ(error_of(bytes),
            "message of 60 bytes goes on for 3 bytes behind its last event [SL0509]");
}

TEST(EventArray, a_camera_has_pixels) {
  const std::string rest =
      " pixels; the driver must set width and height, at most 65536 each [SL0509]";
  EXPECT_EQ(error_of(event_message(0, 260, {})), "its camera has 0 x 260" + rest);
  EXPECT_EQ(error_of(event_message(346, 0, {})), "its camera has 346 x 0" + rest);
  EXPECT_EQ(error_of(event_message(65537, 1, {})), "its camera has 65537 x 1" + rest);
  EXPECT_EQ(error_of(event_message(65536, 65536, {})), "no error");
}

// Every field of every event as Fast-CDR writes it: ROS 2 aligns them.
TEST(EventArray, reads_what_fast_cdr_writes) {
  const Catalog& catalog = Catalog::builtin(Dialect::ros2);
  for (std::size_t count = 0; count < 40; ++count) {
    const auto of = [&](double number) { return reference::Atom{number, {}}; };
    std::vector<reference::Atom> atoms = {of(5),   of(6),   {0, std::string(count % 4, 'f')},
                                          of(260), of(346), of(static_cast<double>(count))};
    for (std::size_t i = 0; i < count; ++i) {
      const auto n = static_cast<double>(i);
      atoms.insert(atoms.end(), {of(1000 + n), of(2000 + n), of(3000 + n), of(4000 + n),
                                 of(i % 2 == 0 ? 1 : 0)});
    }
    auto written = reference::serialize_cdr(catalog, "dvs_msgs/EventArray", atoms);
    const EventArray array(std::as_bytes(std::span(written)), Dialect::ros2);
    EXPECT_EQ(array.height(), 260u);
    EXPECT_EQ(array.width(), 346u);
    ASSERT_EQ(array.size(), count);
    for (std::size_t i = 0; i < count; ++i) {
      const CameraEvent event = array[i];
      EXPECT_EQ(event.x, 1000 + i);
      EXPECT_EQ(event.y, 2000 + i);
      EXPECT_EQ(event.stamp, static_cast<TimeNs>(3000 + i) * kNsPerSecond + 4000 + i);
      EXPECT_EQ(event.on, i % 2 == 0);
    }
    const std::vector<std::uint8_t> cut(written.begin(), written.end() - 1);
    EXPECT_THROW(EventArray(std::as_bytes(std::span(cut)), Dialect::ros2), TransportError);
    written.resize(written.size() + 3);  // as a transport may pad it
    EXPECT_EQ(EventArray(std::as_bytes(std::span(written)), Dialect::ros2).size(), count);
    written.push_back(0);
    EXPECT_THROW(EventArray(std::as_bytes(std::span(written)), Dialect::ros2), TransportError);
  }
}

TEST(EventArray, damaged_bytes_never_lead_outside) {
  std::mt19937 engine(3);
  const auto good = event_message(346, 260, kEvents);
  for (int i = 0; i < 5000; ++i) {
    std::vector<std::byte> damaged = good;
    for (int flips = 0; flips < 3; ++flips) {
      damaged[engine() % damaged.size()] ^= static_cast<std::byte>(1u << (engine() % 8));
    }
    try {
      const EventArray array(damaged, Dialect::ros1);
      for (std::size_t k = 0; k < array.size(); ++k) {
        EXPECT_GE(array[k].stamp, 0);
      }
    } catch (const TransportError&) {
    }
  }
}

}  // namespace
}  // namespace event_array_test
