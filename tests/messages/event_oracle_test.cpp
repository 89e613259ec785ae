// dvs_msgs against genpy, which makes classes and sums of the definitions by itself.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "spikeloop/messages/catalog.hpp"
#include "spikeloop/messages/event_array.hpp"
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

}  // namespace
