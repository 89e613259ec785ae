// dvs_msgs and event_camera_msgs against genpy, which makes classes and sums of the definitions by
// itself.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "spikeloop/messages/catalog.hpp"
#include "spikeloop/messages/event_array.hpp"
#include "spikeloop/messages/event_decoder.hpp"
#include "spikeloop/messages/field_path.hpp"
#include "tests/support/child.hpp"
#include "tests/support/temporary_directory.hpp"

namespace {

using namespace spikeloop;
using namespace spikeloop::messages;

constexpr const char* kScript = R"(
import genpy, genpy.dynamic, io, sys
text = open('definition').read()
classes = genpy.dynamic.generate_dynamic('dvs_msgs/EventArray', text)
Event, EventArray = classes['dvs_msgs/Event'], classes['dvs_msgs/EventArray']
message = EventArray(height=260, width=346)
message.header.frame_id = 'camera'
for i in range(1000):
    message.events.append(Event(x=i % 346, y=i % 260, ts=genpy.Time(10 + i, 999999999 - i),
                                polarity=i % 3 == 0))
buffer = io.BytesIO()
message.serialize(buffer)
open('message', 'wb').write(buffer.getvalue())
print(EventArray._md5sum, Event._md5sum)
)";

TEST(EventOracle, genpy_writes_what_is_read) {
  const test::TemporaryDirectory directory;
  const Catalog& catalog = Catalog::builtin(Dialect::ros1);
  directory.write("definition", catalog.full_text("dvs_msgs/EventArray"));
  const auto outcome = test::run(
      {.arguments = {"/usr/bin/python3", "-c", kScript}, .directory = directory.path().string()});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.text();
  EXPECT_EQ(outcome.out,
            catalog.md5("dvs_msgs/EventArray") + " " + catalog.md5("dvs_msgs/Event") + "\n");
  const std::string bytes = directory.read("message");
  const EventArray array(std::as_bytes(std::span(bytes)), Dialect::ros1);
  EXPECT_EQ(array.width(), 346u);
  EXPECT_EQ(array.height(), 260u);
  ASSERT_EQ(array.size(), 1000u);
  for (std::size_t i = 0; i < 1000; ++i) {
    const CameraEvent event = array[i];
    ASSERT_EQ(event.x, i % 346);
    ASSERT_EQ(event.y, i % 260);
    const auto n = static_cast<TimeNs>(i);
    ASSERT_EQ(event.stamp, (10 + n) * kNsPerSecond + 999'999'999 - n);
    ASSERT_EQ(event.on, i % 3 == 0);
  }
}

constexpr const char* kPacketScript = R"(
import genpy, genpy.dynamic, io
text = open('definition').read()
EventPacket = genpy.dynamic.generate_dynamic('event_camera_msgs/EventPacket', text)[
    'event_camera_msgs/EventPacket']
message = EventPacket(height=720, width=1280, seq=7, time_base=123456789012, encoding='evt3',
                      is_bigendian=True, events=bytes(range(256)))
message.header.frame_id = 'camera'
buffer = io.BytesIO()
message.serialize(buffer)
open('message', 'wb').write(buffer.getvalue())
print(EventPacket._md5sum)
)";

TEST(EventOracle, genpy_writes_the_packets_that_are_read) {
  const test::TemporaryDirectory directory;
  const Catalog& catalog = Catalog::builtin(Dialect::ros1);
  const std::string type = "event_camera_msgs/EventPacket";
  directory.write("definition", catalog.full_text(type));
  const auto outcome = test::run({.arguments = {"/usr/bin/python3", "-c", kPacketScript},
                                  .directory = directory.path().string()});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.text();
  EXPECT_EQ(outcome.out, catalog.md5(type) + "\n");
  const std::string written = directory.read("message");
  const auto bytes = std::as_bytes(std::span(written));
  std::vector<double> numbers;
  for (const char* path : {"height", "width", "seq", "time_base", "is_bigendian"}) {
    FieldReader(catalog, type, path).read(bytes, numbers);
  }
  EXPECT_EQ(numbers, (std::vector<double>{720, 1280, 7, 123456789012, 1}));
  std::vector<std::string_view> texts;
  TextField(catalog, type, "encoding").read(bytes, texts);
  TextField(catalog, type, "header.frame_id").read(bytes, texts);
  EXPECT_EQ(texts, (std::vector<std::string_view>{"evt3", "camera"}));
  const auto events = read_event_packet(Dialect::ros1, bytes).events;
  ASSERT_EQ(events.size(), 256u);
  for (std::size_t i = 0; i < events.size(); ++i) {
    EXPECT_EQ(events[i], static_cast<std::byte>(i));
  }
}

}  // namespace
