// Spikes through our programs under MUSIC: each exactly once, at its exact time, in the tick that
// MUSIC's schedule says.
#include <algorithm>

#include "job.hpp"

namespace spikeloop::test {
namespace {

// A schedule of spikes, and what a sink without delay must see of it.
struct Schedule {
  std::string file;
  std::vector<LoggedEvent> expected;

  /// A spike at `ns` is sent before the tick whose interval (kh, (k+1)h] holds it.
  void add(long long ns, int id, long long tick_ns, long long delay_ns = 0) {
    const auto tick = static_cast<int>((ns + tick_ns - 1) / tick_ns - 1);
    char line[80];
    std::snprintf(line, sizeof line, "%d %.17g %d\n", tick, static_cast<double>(ns) / 1e9, id);
    file += line;
    expected.push_back({tick, static_cast<double>(ns + delay_ns) / 1e9, id});
  }
};

constexpr long long kMs = 1'000'000;

Schedule busy_schedule(long long tick_ns, int ticks, int width) {
  Schedule schedule;
  unsigned state = 12345;
  for (long long k = 0; k < ticks; ++k) {
    std::vector<long long> times;
    for (int i = 0; i < 3; ++i) {
      state = state * 1664525u + 1013904223u;
      times.push_back(k * tick_ns + 1001 + static_cast<long long>(state % (tick_ns - 1001)));
    }
    std::sort(times.begin(), times.end());
    for (const auto time : times) {
      state = state * 1664525u + 1013904223u;
      schedule.add(time, static_cast<int>((state >> 8) % static_cast<unsigned>(width)), tick_ns);
    }
  }
  return schedule;
}

class SpikesEitherOrder : public testing::TestWithParam<bool> {};

TEST_P(SpikesEitherOrder, EverySpikePassesOnceWithoutSimulatedDelay) {
  const auto schedule = busy_schedule(kMs, 200, 10);
  Job job;
  job.global("stoptime=0.2");
  const std::string source = "spikes=" + job.directory.write("spikes.txt", schedule.file);
  if (GetParam()) {
    job.raw("sink").node("relay", "spike_relay").raw("source", source);
  } else {
    job.raw("source", source).node("relay", "spike_relay").raw("sink");
  }
  job.connect("source.spikes -> relay.in [10]").connect("relay.out -> sink.spikes_in [10]");
  expect_clean(job.run());
  EXPECT_EQ(job.events("sink"), schedule.expected);
}
INSTANTIATE_TEST_SUITE_P(Sections, SpikesEitherOrder, testing::Values(true, false),
                         [](const auto& test) {
                           return test.param ? "DownstreamFirst" : "UpstreamFirst";
                         });

TEST(Spikes, BothEndsOfAnIntervalBelongWhereTheyAreStamped) {
  Schedule schedule;
  for (int k = 0; k < 20; ++k) {
    schedule.add(k * kMs + 1, 0, kMs);
    schedule.add((k + 1) * kMs, 1, kMs);
  }
  Job job;
  job.global("stoptime=0.02");
  job.raw("sink")
      .node("relay", "spike_relay", "stamp_guard=false")
      .raw("source", "spikes=" + job.directory.write("spikes.txt", schedule.file))
      .connect("source.spikes -> relay.in [2]")
      .connect("relay.out -> sink.spikes_in [2]");
  expect_clean(job.run());
  EXPECT_EQ(job.events("sink"), schedule.expected);
}

TEST(Spikes, AnAcceptableLatencyOfOneTickBringsThemOneTickLate) {
  Schedule schedule;
  for (int k = 0; k < 50; ++k) {
    schedule.add(k * kMs + 500'000, k % 3, kMs, kMs);
  }
  Job job;
  job.global("stoptime=0.051");
  job.raw("sink")
      .node("relay", "spike_relay", "accept_latency=0.001\ndelay=0.001")
      .raw("source", "spikes=" + job.directory.write("spikes.txt", schedule.file))
      .connect("source.spikes -> relay.in [3]")
      .connect("relay.out -> sink.spikes_in [3]");
  expect_clean(job.run());
  auto expected = schedule.expected;
  for (auto& event : expected) {
    ++event.tick;
  }
  EXPECT_EQ(job.events("sink"), expected);
}

struct Loop {
  const char* relay;
  const char* back;
  int round_trip;
};
class ClosedLoop : public testing::TestWithParam<Loop> {};

TEST_P(ClosedLoop, ComesBackAfterTheTicksThatTheLatenciesLeave) {
  Schedule schedule;
  for (int k = 0; k < 100; ++k) {
    schedule.add(k * kMs + 250'000, k % 5, kMs);
  }
  Job job;
  job.global("stoptime=0.103");
  job.node("relay", "spike_relay", GetParam().relay)
      .raw("body",
           "spikes=" + job.directory.write("spikes.txt", schedule.file) + "\n" + GetParam().back)
      .connect("body.spikes -> relay.in [5]")
      .connect("relay.out -> body.spikes_in [5]");
  expect_clean(job.run());
  const auto events = job.events("body");
  ASSERT_EQ(events.size(), schedule.expected.size());
  for (std::size_t i = 0; i < events.size(); ++i) {
    EXPECT_EQ(events[i].tick, schedule.expected[i].tick + GetParam().round_trip);
    EXPECT_EQ(events[i].id, schedule.expected[i].id);
  }
}
INSTANTIATE_TEST_SUITE_P(Latencies, ClosedLoop,
                         testing::Values(Loop{"accept_latency=0.0009", "latency=0.0011", 1},
                                         Loop{"accept_latency=0.001\ndelay=0.001", "latency=0.001",
                                              2},
                                         Loop{"accept_latency=0", "latency=0.002", 2}),
                         [](const auto& test) { return "Case" + std::to_string(test.index); });

TEST(Spikes, TheStampGuardKeepsThemOneMicrosecondAwayFromTheBegin) {
  Job job;
  job.global("stoptime=0.01");
  job.raw("sink").node("cell", "edge_spiker").connect("cell.out -> sink.spikes_in [2]");
  expect_clean(job.run());
  std::vector<LoggedEvent> expected;
  for (int k = 0; k < 10; ++k) {
    expected.push_back({k, static_cast<double>(k * kMs + 1000) / 1e9, 0});
    expected.push_back({k, static_cast<double>((k + 1) * kMs) / 1e9, 1});
  }
  EXPECT_EQ(job.events("sink"), expected);
}

TEST(Spikes, AForeignSenderMayMapMoreOrFewerChannels) {
  Schedule schedule;
  for (int k = 0; k < 10; ++k) {
    schedule.add(k * kMs + 5000, k, kMs);
  }
  for (const char* mapped : {"map_out=5", "map_out=20"}) {
    Job job;
    job.global("stoptime=0.01");
    job.raw("sink")
        .node("relay", "spike_relay")
        .raw("source", "spikes=" + job.directory.write("spikes.txt", schedule.file) + "\n" + mapped)
        .connect("source.spikes -> relay.in [7]")
        .connect("relay.out -> sink.spikes_in [7]");
    expect_clean(job.run());
    const std::size_t channels = mapped == std::string("map_out=5") ? 5 : 7;
    const auto& all = schedule.expected;
    EXPECT_EQ(job.events("sink"),
              std::vector<LoggedEvent>(all.begin(), all.begin() + static_cast<long>(channels)));
  }
}

TEST(Spikes, OtherTicksWork) {
  constexpr long long kTick = 12'500'000;
  const auto schedule = busy_schedule(kTick, 40, 4);
  Job job;
  job.global("stoptime=0.5").global("music_timestep=0.0125");
  job.raw("sink")
      .node("relay", "spike_relay")
      .raw("source", "spikes=" + job.directory.write("spikes.txt", schedule.file))
      .connect("source.spikes -> relay.in [4]")
      .connect("relay.out -> sink.spikes_in [4]");
  expect_clean(job.run());
  EXPECT_EQ(job.events("sink"), schedule.expected);
}

}  // namespace
}  // namespace spikeloop::test
