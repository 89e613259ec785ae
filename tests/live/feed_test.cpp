#include "spikeloop/live/feed.hpp"

#include <atomic>
#include <cstring>
#include <fstream>

#include "spikeloop/core/error.hpp"
#include "tests/support/temporary_directory.hpp"

namespace spikeloop::live {
namespace {

using ::testing::IsEmpty;
using ::testing::SizeIs;

constexpr std::size_t kRing = 4096;

std::vector<std::byte> bytes_of(std::uint64_t number, std::size_t size) {
  std::vector<std::byte> bytes(size, static_cast<std::byte>(number));
  if (size != 0) {
    std::memcpy(bytes.data(), &number, std::min(size, sizeof(number)));
  }
  return bytes;
}

/// Every byte says which message it is one of.
bool is_message(std::span<const std::byte> message, std::uint64_t number) {
  const auto wanted = bytes_of(number, message.size());
  return std::ranges::equal(message, wanted);
}

class FeedTest : public ::testing::Test {
 protected:
  FeedReader reader() { return FeedReader(directory_.path() / "part.feed"); }

  test::TemporaryDirectory directory_;
  Feed feed_{directory_.path(), {.process = "part", .commands = true}, kRing};
};

TEST_F(FeedTest, TellsProcessAndChannels) {
  FeedReader reader = this->reader();
  EXPECT_EQ(reader.about().process, "part");
  EXPECT_TRUE(reader.about().commands);
  EXPECT_FALSE(reader.about().pausable);
  EXPECT_THAT(reader.new_channels(), IsEmpty());
  EXPECT_EQ(feed_.add({"/a", "cdr", "pkg/msg/A", "ros2msg", "int64 x\n\"quoted\"\n"}), 0);
  EXPECT_EQ(feed_.add({"/b", "json", "B", "jsonschema", "{}"}), 1);
  const auto channels = reader.new_channels();
  ASSERT_THAT(channels, SizeIs(2));
  EXPECT_EQ(channels[0].schema, "int64 x\n\"quoted\"\n");
  EXPECT_EQ(channels[1].topic, "/b");
  EXPECT_THAT(reader.new_channels(), IsEmpty());
}

TEST_F(FeedTest, MessagesComeInOrderAndWhole) {
  FeedReader reader = this->reader();
  for (std::uint64_t i = 0; i < 1000; ++i) {  // many times around
    const std::size_t size = i * 37 % 1500;
    feed_.publish(static_cast<std::uint32_t>(i % 3), static_cast<TimeNs>(i), bytes_of(i, size));
    const auto record = reader.next();
    ASSERT_TRUE(record);
    EXPECT_EQ(record->channel, i % 3);
    EXPECT_EQ(record->time, static_cast<TimeNs>(i));
    ASSERT_THAT(record->message, SizeIs(size));
    EXPECT_TRUE(is_message(record->message, i));
    EXPECT_FALSE(reader.next());
  }
  EXPECT_EQ(reader.lost(), 0);
}

TEST_F(FeedTest, ASlowReaderLosesTheOldestAndCountsThem) {
  FeedReader reader = this->reader();
  for (std::uint64_t i = 0; i < 100; ++i) {
    feed_.publish(0, 0, bytes_of(i, 84));  // 104 bytes in the ring, 39 of them fit
  }
  EXPECT_FALSE(reader.next()) << "the newest counts: it begins anew";
  EXPECT_EQ(reader.lost(), 100 * 104);
  feed_.publish(0, 7, bytes_of(100, 84));
  const auto record = reader.next();
  ASSERT_TRUE(record);
  EXPECT_TRUE(is_message(record->message, 100));
}

TEST_F(FeedTest, AMessageOfMoreThanHalfTheRingIsLeftOut) {
  FeedReader reader = this->reader();
  feed_.publish(0, 0, bytes_of(1, kRing / 2));
  EXPECT_FALSE(reader.next());
  EXPECT_EQ(reader.lost(), kRing / 2);
  feed_.publish(0, 0, bytes_of(2, kRing / 2 - 16));
  EXPECT_TRUE(reader.next());
}

/// Under ThreadSanitizer, too.
TEST_F(FeedTest, NoMessageIsTornWhileItIsOverwritten) {
  constexpr std::uint64_t kMessages = 100'000;
  constexpr std::uint64_t kRead = 1000;
  std::atomic<bool> written{false};
  std::atomic<std::uint64_t> read{0};
  std::thread writer([&] {
    // On a busy machine the reader may be left behind for long.
    for (std::uint64_t i = 1; i <= kMessages || read < kRead; ++i) {
      feed_.publish(0, static_cast<TimeNs>(i), bytes_of(i, 8 + i % 200));
    }
    written = true;
  });
  FeedReader reader = this->reader();
  TimeNs last = 0;
  for (bool ended = false; !ended;) {
    ended = written;
    while (const auto record = reader.next()) {
      ++read;
      const auto number = static_cast<std::uint64_t>(record->time);
      EXPECT_GT(record->time, last);
      last = record->time;
      EXPECT_TRUE(record->message.size() == 8 + number % 200 && is_message(record->message, number))
          << number;
    }
  }
  writer.join();
  EXPECT_GE(read, kRead);
}

TEST_F(FeedTest, TheViewAsks) {
  FeedReader reader = this->reader();
  EXPECT_FALSE(feed_.stop_pressed());
  EXPECT_EQ(feed_.speed(), 0);
  StopFlag stop(directory_.path());
  stop.press(true);
  reader.pause(true);
  reader.step();
  reader.set_speed(0.5);
  EXPECT_TRUE(feed_.stop_pressed());
  EXPECT_TRUE(feed_.paused());
  EXPECT_EQ(feed_.steps(), 1);
  EXPECT_EQ(feed_.speed(), 0.5);
  stop.press(false);
  EXPECT_FALSE(feed_.stop_pressed());
  EXPECT_FALSE(feed_.watched());
  reader.watch();
  EXPECT_TRUE(feed_.watched());
}

TEST_F(FeedTest, AProcessThatBeginsAfterStopWasPressedIsStopped) {
  StopFlag(directory_.path()).press(true);
  const Feed late(directory_.path(), {.process = "late", .commands = true}, kRing);
  EXPECT_TRUE(late.stop_pressed());
}

TEST_F(FeedTest, ParametersChange) {
  EXPECT_TRUE(feed_.add(Parameter{"encoder.rate_max", 200, 0, 1e6, "Hz"}));
  EXPECT_TRUE(feed_.add(Parameter{"encoder.rate_min", 1, 0, 1e6, "Hz"}));
  FeedReader reader = this->reader();
  EXPECT_THAT(reader.new_channels(), IsEmpty());
  ASSERT_THAT(reader.parameters(), SizeIs(2));
  EXPECT_EQ(reader.parameters()[1].name, "encoder.rate_min");
  EXPECT_EQ(reader.value(0), 200);
  EXPECT_THAT(feed_.changes(), IsEmpty());
  reader.change(1, 5);
  reader.change(1, 7);
  EXPECT_THAT(feed_.changes(), ::testing::ElementsAre(std::pair<std::size_t, double>(1, 7)));
  EXPECT_THAT(feed_.changes(), IsEmpty());
  feed_.set(0, 3);
  EXPECT_EQ(reader.value(0), 3);
  EXPECT_THAT(feed_.changes(), IsEmpty());
}

TEST_F(FeedTest, WhatWasToldBeforeANewBeginIsNotRead) {
  FeedReader reader = this->reader();
  feed_.publish(0, 1, bytes_of(1, 8));
  feed_.begin_anew();
  feed_.publish(0, 2, bytes_of(2, 8));
  EXPECT_FALSE(reader.next()) << "viewers are to know of the begin first";
  EXPECT_EQ(reader.beginnings(), 1);
  const auto record = reader.next();
  ASSERT_TRUE(record);
  EXPECT_EQ(record->time, 2);
  EXPECT_EQ(reader.beginnings(), 1);
  EXPECT_FALSE(reader.next());
}

TEST_F(FeedTest, OtherFilesAreRefused) {
  EXPECT_THROW(FeedReader(directory_.path() / "no.feed"), FileError);
  EXPECT_THROW(FeedReader(directory_.write("empty.feed", "")), FileError);
  EXPECT_THROW(FeedReader(directory_.write("zeros.feed", std::string(4 << 20, '\0'))), FileError);
}

TEST(Feed, ARunThatCanBePausedBeginsAtRealTime) {
  const test::TemporaryDirectory directory;
  const Feed feed(directory.path(), {.process = "part", .pausable = true}, kRing);
  EXPECT_EQ(feed.speed(), 1);
}

TEST(Feed, NoRoomIsAnError) {
  EXPECT_THROW(Feed("/nowhere", {.process = "part"}), FileError);
}

}  // namespace
}  // namespace spikeloop::live
