#include "spikeloop/process/transfer.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <vector>

namespace spikeloop::music {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

TEST(StampGuard, MovesWhatIsTooEarlyAndNothingElse) {
  const Interval interval{5'000'000, 6'000'000};
  EXPECT_EQ(guarded_stamp(5'000'001, interval), 5'001'000);
  EXPECT_EQ(guarded_stamp(5'000'999, interval), 5'001'000);
  EXPECT_EQ(guarded_stamp(5'001'000, interval), 5'001'000);
  EXPECT_EQ(guarded_stamp(5'001'001, interval), 5'001'001);
  EXPECT_EQ(guarded_stamp(6'000'000, interval), 6'000'000);
}

TEST(StampGuard, MovesLateSpikesToo) {
  EXPECT_EQ(guarded_stamp(4'000'000, {5'000'000, 6'000'000}), 5'001'000);
}

TEST(StampGuard, StaysInsideATickShorterThanItself) {
  EXPECT_EQ(guarded_stamp(5'001, {5'000, 5'100}), 5'100);
}

TEST(MusicSeconds, IsTheDoubleThatAForeignProgramComputes) {
  EXPECT_EQ(music_seconds(1'000'000), 0.001);
  EXPECT_EQ(music_seconds(3'000'000), 0.003);
  EXPECT_EQ(music_seconds(123'456'789), 0.123456789);
}

TEST(SpikeDelay, MakesEarlyAndLateSpikesComeAtOneTime) {
  const auto times = [](std::span<const Spike> spikes) {
    std::vector<TimeNs> result;
    for (const Spike& spike : spikes) {
      result.push_back(spike.time_ns);
    }
    return result;
  };
  SpikeDelay delay(100);
  const std::vector<Spike> first = {make_spike(110, 0), make_spike(20, 1), make_spike(200, 2)};
  // Spike 1 came late; spike 0 is due in the next interval, spike 2 at the very end of it.
  EXPECT_EQ(times(delay.pass(first, {100, 200})), std::vector<TimeNs>{120});
  EXPECT_EQ(times(delay.pass({}, {200, 300})), (std::vector<TimeNs>{210, 300}));
  EXPECT_TRUE(delay.pass({}, {300, 400}).empty());
}

TEST(SpikeInbox, KeepsTimesToTheNanosecondThroughFortyDays) {
  SpikeInbox inbox(1);
  const TimeNs forty_days = TimeNs{40} * 86400 * kNsPerSecond;
  std::vector<TimeNs> times;
  for (const TimeNs base : {TimeNs{0}, kNsPerSecond, TimeNs{86400} * kNsPerSecond, forty_days}) {
    for (const TimeNs offset : {0, 1, 499'999, 1'000'000, 999'999'999}) {
      times.push_back(base + offset);
      inbox.add(music_seconds(times.back()), 0);
    }
  }
  ASSERT_EQ(inbox.spikes().size(), times.size());
  for (std::size_t i = 0; i < times.size(); ++i) {
    EXPECT_EQ(inbox.spikes()[i].time_ns, times[i]);
  }
}

TEST(SpikeInbox, TakesTheTicksOfForeignProgramsAsTheyAccumulate) {
  SpikeInbox inbox(1);
  double sum = 0;
  for (int k = 1; k <= 1000; ++k) {
    sum += 0.001;  // not the double nearest to k ms
    inbox.add(sum, 0);
    EXPECT_EQ(inbox.spikes().back().time_ns, k * 1'000'000);
  }
}

TEST(SpikeInbox, DropsAndCountsIdsOutsideThePort) {
  SpikeInbox inbox(3);
  for (const int id : {-1, 0, 2, 3, 1'000'000}) {
    inbox.add(0.5, id);
  }
  ASSERT_EQ(inbox.spikes().size(), 2u);
  EXPECT_EQ(inbox.spikes()[0].channel, 0);
  EXPECT_EQ(inbox.spikes()[1].channel, 2);
  EXPECT_EQ(inbox.outside_port(), 3u);
}

TEST(SpikeInbox, DropsAndCountsWhatHasNoTime) {
  SpikeInbox inbox(3);
  for (const double time : {kNan, kInfinity, -kInfinity, 1e12, -1e12, -1.0}) {
    inbox.add(time, 0);
  }
  ASSERT_EQ(inbox.spikes().size(), 1u);
  EXPECT_EQ(inbox.spikes()[0].time_ns, -kNsPerSecond);
  EXPECT_EQ(inbox.without_time(), 5u);
}

TEST(SpikeInbox, IsEmptyAfterClear) {
  SpikeInbox inbox(1);
  inbox.add(0.1, 0);
  inbox.clear();
  EXPECT_TRUE(inbox.spikes().empty());
}

TEST(SignalBlock, BeginsInvalidAndStaysSoWhileAllIsNan) {
  SignalBlock block(2);
  EXPECT_EQ(block.revision(), 0u);
  EXPECT_FALSE(block.update(std::vector<double>{kNan, kNan}));
  EXPECT_EQ(block.revision(), 0u);
}

TEST(SignalBlock, OneNumberAmongNansIsAnOrdinaryInput) {
  SignalBlock block(2);
  EXPECT_TRUE(block.update(std::vector<double>{kNan, 0.5}));
  EXPECT_NE(block.revision(), 0u);
}

TEST(SignalBlock, RaisesItsRevisionOnlyWhenABitChanges) {
  SignalBlock block(2);
  EXPECT_TRUE(block.update(std::vector<double>{0.0, 0.5}));
  const auto first = block.revision();
  EXPECT_FALSE(block.update(std::vector<double>{0.0, 0.5}));
  EXPECT_EQ(block.revision(), first);
  EXPECT_TRUE(block.update(std::vector<double>{-0.0, 0.5}));
  EXPECT_GT(block.revision(), first);
}

TEST(SignalBlock, AValueAfterAGapIsNews) {
  SignalBlock block(1);
  block.update(std::vector<double>{0.5});
  const auto before = block.revision();
  EXPECT_TRUE(block.update(std::vector<double>{kNan}));
  EXPECT_EQ(block.revision(), 0u);
  EXPECT_TRUE(block.update(std::vector<double>{0.5}));
  EXPECT_GT(block.revision(), before);
}

}  // namespace
}  // namespace spikeloop::music
