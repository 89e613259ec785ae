// When a camera's events are sent, without ROS.
#include "spikeloop/messages/event_playback.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

namespace event_playback_test {
namespace {

using namespace spikeloop;
using namespace spikeloop::messages;
using testing::ElementsAre;
using testing::IsEmpty;

constexpr TimeNs kMs = 1'000'000;
constexpr TimeNs kSensor = 1'700'000'000 * kNsPerSecond;  // what its clock shows at first

/// Stamps of the sensor in ms behind kSensor, all on one channel.
EventMessage message(const std::vector<double>& stamps_ms, std::int32_t channel = 0) {
  EventMessage made;
  for (const double stamp : stamps_ms) {
    made.events.push_back(
        make_spike(kSensor + static_cast<TimeNs>(stamp * static_cast<double>(kMs)), channel));
    made.newest = std::max(made.newest.value_or(0), made.events.back().time_ns);
  }
  return made;
}

/// Intervals of 1 ms, one after the other.
class Player {
 public:
  explicit Player(double latency_ms)
      : playback(static_cast<TimeNs>(latency_ms * static_cast<double>(kMs))) {
    step({});
  }
  /// The times in ms at which the spikes of the next interval are sent.
  std::vector<double> step(const std::vector<EventMessage>& messages) {
    const Interval interval{begin, begin + kMs};
    begin = interval.end;
    std::vector<double> times;
    for (const Spike& spike : playback.step(messages, interval)) {
      EXPECT_TRUE(interval.contains(spike.time_ns)) << spike.time_ns;
      times.push_back(static_cast<double>(spike.time_ns) / static_cast<double>(kMs));
    }
    return times;
  }

  EventPlayback playback;
  TimeNs begin = 0;
};

TEST(EventPlayback, the_first_message_says_how_far_apart_the_clocks_are) {
  Player player(10);
  player.step({});
  // Taken at 2 ms: 7.25 of the sensor is 2 ms, and is sent at 12 ms.
  EXPECT_THAT(player.step({message({0, 2.5, 7.25})}), IsEmpty());
  EXPECT_THAT(player.step({}), IsEmpty());
  EXPECT_THAT(player.step({}), ElementsAre(4.75));
  EXPECT_THAT(player.step({}), IsEmpty());
  EXPECT_THAT(player.step({}), IsEmpty());
  EXPECT_THAT(player.step({}), ElementsAre(7.25));
  EXPECT_EQ(player.playback.waiting(), 1u);
  for (int i = 0; i < 3; ++i) {
    EXPECT_THAT(player.step({}), IsEmpty());
  }
  EXPECT_THAT(player.step({}), ElementsAre(12)) << "the border belongs to the interval before";
  EXPECT_EQ(player.playback.late(), 0u);
  EXPECT_EQ(player.playback.waiting(), 0u);
}

TEST(EventPlayback, later_messages_keep_their_spacing_whenever_they_come) {
  Player player(5);
  player.step({message({0})});  // at 1 ms: 0 is 1 ms, sent at 6 ms
  player.step({message({1.5}), message({1.75})});
  player.step({});
  player.step({message({3.25})});
  EXPECT_THAT(player.step({}), ElementsAre(6));
  EXPECT_THAT(player.step({}), IsEmpty());
  EXPECT_THAT(player.step({}), ElementsAre(7.5, 7.75));
  EXPECT_THAT(player.step({}), IsEmpty());
  EXPECT_THAT(player.step({}), ElementsAre(9.25));
}

TEST(EventPlayback, what_is_late_is_sent_at_once_and_counted) {
  Player player(2);
  player.step({});
  // At 2 ms; 5 of the sensor is 2 ms. 1 and 3 should have been sent at 0 and 2 ms.
  EXPECT_THAT(player.step({message({1, 3, 4, 5})}), ElementsAre(2.000001, 2.000001, 3));
  EXPECT_EQ(player.playback.late(), 2u);
  EXPECT_EQ(player.playback.worst_lateness(), 2 * kMs + 1);
  EXPECT_THAT(player.step({}), ElementsAre(4));
}

TEST(EventPlayback, an_event_that_just_comes_in_time_is_not_late) {
  Player player(1);
  EXPECT_THAT(player.step({message({0})}), ElementsAre(2));
  EXPECT_EQ(player.playback.late(), 0u);
  Player soon(0);
  EXPECT_THAT(soon.step({message({0})}), ElementsAre(1.000001));
  EXPECT_EQ(soon.playback.late(), 1u);
  EXPECT_EQ(soon.playback.worst_lateness(), 1);
}

TEST(EventPlayback, the_first_interval_has_messages_as_all_others) {
  EventPlayback playback(5 * kMs);
  EXPECT_EQ(playback.step(std::vector{message({100})}, {0, 10 * kMs})[0].time_ns, 5 * kMs);
  EXPECT_EQ(playback.late(), 0u);
}

TEST(EventPlayback, a_clock_that_jumps_back_is_set_again) {
  Player player(3);
  player.step({message({1000, 1001})});  // at 1 ms: 1001 is 1 ms
  EXPECT_THAT(player.step({}), ElementsAre(3));
  EXPECT_THAT(player.step({message({1003})}), ElementsAre(4));
  EXPECT_THAT(player.step({message({0, 0.5})}), IsEmpty());  // at 4 ms: 0.5 is 4 ms
  EXPECT_EQ(player.playback.clock_jumps(), 1u);
  EXPECT_THAT(player.step({message({1.5})}), ElementsAre(6));
  EXPECT_THAT(player.step({}), ElementsAre(6.5, 7));
  EXPECT_THAT(player.step({}), ElementsAre(8));
  EXPECT_EQ(player.playback.late(), 0u);
  EXPECT_EQ(player.playback.clock_jumps(), 1u);
}

TEST(EventPlayback, a_clock_that_jumps_far_ahead_is_set_again) {
  Player player(1);
  player.step({message({0})});
  player.step({message({900})});  // within a second: it waits
  EXPECT_EQ(player.playback.clock_jumps(), 0u);
  EXPECT_EQ(player.playback.waiting(), 1u);
  EXPECT_THAT(player.step({message({5'000'000})}), ElementsAre(4));
  EXPECT_EQ(player.playback.clock_jumps(), 1u);
  EXPECT_THAT(player.step({message({5'000'001})}), ElementsAre(5));
}

TEST(EventPlayback, one_mad_stamp_in_a_message_does_not_wait_for_ever) {
  Player player(1);
  player.step({message({0})});
  EXPECT_THAT(player.step({message({1, 1e9, 1.5})}), ElementsAre(2.000001, 2.000001, 3));
  EXPECT_EQ(player.playback.clock_jumps(), 1u);
  EXPECT_EQ(player.playback.waiting(), 0u);
}

TEST(EventPlayback, messages_without_events_say_nothing) {
  Player player(1);
  EXPECT_THAT(player.step({EventMessage{}}), IsEmpty());
  EventMessage left_out;  // all of it: its time counts
  left_out.newest = kSensor;
  EXPECT_THAT(player.step({left_out}), IsEmpty());
  EXPECT_THAT(player.step({message({0.5})}), ElementsAre(3.5));
}

/// Whatever comes in whatever order: everything is sent once, in order, in its own interval, at its
/// own time unless it is late.
TEST(EventPlayback, nothing_is_lost_or_doubled) {
  std::mt19937 random(9);
  for (int round = 0; round < 50; ++round) {
    Player player(3);
    std::size_t given = 0;
    std::vector<double> sent;
    double sensor_ms = 1000;
    for (int tick = 0; tick < 300; ++tick) {
      std::vector<EventMessage> messages;
      for (auto k = random() % 3; k > 0 && tick < 280; --k) {
        std::vector<double> stamps;
        for (auto i = random() % 20; i > 0; --i) {
          stamps.push_back(sensor_ms - 0.001 * static_cast<double>(random() % 6000));
        }
        sensor_ms += random() % 50 == 0 ? -500 : 1;
        given += stamps.size();
        messages.push_back(message(stamps, static_cast<std::int32_t>(k)));
      }
      const auto times = player.step(messages);
      EXPECT_TRUE(std::is_sorted(times.begin(), times.end()));
      sent.insert(sent.end(), times.begin(), times.end());
    }
    EXPECT_EQ(sent.size() + player.playback.waiting(), given);
    EXPECT_TRUE(std::is_sorted(sent.begin(), sent.end()));
  }
}

}  // namespace
}  // namespace event_playback_test
