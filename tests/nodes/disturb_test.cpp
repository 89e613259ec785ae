// Disturbances against what probability says of them, and their schedule.
#include <algorithm>
#include <cmath>
#include <set>

#include "harness.hpp"

namespace spikeloop::testing {
namespace {

using Keys = std::map<std::string, std::string>;

NodeHarness spikes_with(const Keys& keys, std::uint32_t width = 1, std::uint64_t seed = 1) {
  return {"disturb_spikes", {width, width}, {.keys = keys, .seed = seed}};
}

NodeHarness signal_with(const Keys& keys, std::uint32_t width = 1) {
  return {"disturb_signal", {width, width}, {.keys = keys}};
}

/// A spike of every channel in the middle of every millisecond.
void feed(NodeHarness& node, std::int32_t width, int count, TimeNs tick = kMs) {
  for (int i = 0; i < count; ++i) {
    for (std::int32_t c = 0; c < width; ++c) {
      node.add_spike(node.time() + kMs / 2, c);
    }
    node.run_until(node.time() + kMs, tick);
  }
}

TEST(DisturbSpikes, WithoutKeysAllPass) {
  NodeHarness node = spikes_with({}, 3);
  feed(node, 3, 100);
  EXPECT_EQ(node.spikes().size(), 300U);
  EXPECT_EQ(node.spikes().front().time_ns, kMs / 2);
  EXPECT_EQ(node.counter("dropped"), 0U);
}

TEST(DisturbSpikes, AreLostWithTheirProbability) {
  NodeHarness node = spikes_with({{"drop", "0.3"}}, 10);
  feed(node, 10, 2000);
  const double n = 20'000;
  EXPECT_NEAR(static_cast<double>(node.counter("dropped")), 0.3 * n, 4 * std::sqrt(n * 0.3 * 0.7));
  EXPECT_EQ(node.spikes().size() + node.counter("dropped"), 20'000U);
}

TEST(DisturbSpikes, AreDelayedByUniformTimesAcrossTicks) {
  NodeHarness node = spikes_with({{"jitter", "5 ms"}});
  feed(node, 1, 4000);
  node.run_until(node.time() + 10 * kMs, kMs);
  const auto spikes = node.spikes();
  ASSERT_EQ(spikes.size(), 4000U);
  double sum = 0;
  for (const Spike& spike : spikes) {
    sum += static_cast<double>(spike.time_ns) / kMs;
  }
  // Sent at 0.5, 1.5, ... ms: what is left is the mean delay, of a uniform distribution.
  EXPECT_NEAR(sum / 4000 - 2000, 2.5, 4 * 5 / std::sqrt(12 * 4000.0));
}

TEST(DisturbSpikes, ALesionSilencesItsShareForGood) {
  NodeHarness node = spikes_with({{"lesion", "0.25"}}, 40);
  feed(node, 40, 50);
  std::set<std::int32_t> alive;
  for (const Spike& spike : node.spikes()) {
    alive.insert(spike.channel);
  }
  EXPECT_EQ(alive.size(), 30U);
  EXPECT_EQ(node.spikes().size(), 30U * 50);
  NodeHarness other = spikes_with({{"lesion", "0.25"}}, 40, 2);
  feed(other, 40, 50);
  std::set<std::int32_t> others;
  for (const Spike& spike : other.spikes()) {
    others.insert(spike.channel);
  }
  EXPECT_NE(alive, others) << "another seed, other neurons";
}

TEST(DisturbSpikes, OnlyWithinTheirTime) {
  NodeHarness node = spikes_with({{"drop", "1"}, {"from", "10 ms"}, {"to", "20 ms"}});
  feed(node, 1, 30);
  EXPECT_EQ(node.spikes().size(), 20U);
  EXPECT_EQ(node.counter("dropped"), 10U);
}

TEST(DisturbSpikes, DoNotDependOnTheTick) {
  const Keys keys{{"drop", "0.2"}, {"jitter", "3 ms"}};
  NodeHarness fine = spikes_with(keys, 5);
  NodeHarness coarse = spikes_with(keys, 5);
  for (int i = 0; i < 50; ++i) {
    for (int k = 0; k < 10; ++k) {
      for (std::int32_t c = 0; c < 5; ++c) {
        coarse.add_spike(coarse.time() + k * kMs + kMs / 2, c);
      }
    }
    coarse.step(10 * kMs);
  }
  feed(fine, 5, 500);
  fine.run_until(fine.time() + 10 * kMs, kMs);
  coarse.run_until(coarse.time() + 10 * kMs, 10 * kMs);
  const auto key = [](const Spike& spike) { return std::pair(spike.time_ns, spike.channel); };
  EXPECT_TRUE(std::ranges::equal(fine.spikes(), coarse.spikes(), {}, key, key));
}

TEST(DisturbSpikes, EndAfterTheirBegin) {
  EXPECT_NE(message_of([] {
              spikes_with({{"from", "2 s"}, {"to", "1 s"}});
            }).find("key 'from'"),
            std::string::npos);
}

TEST(DisturbSignal, NoiseAndBiasHaveTheirMoments) {
  NodeHarness node = signal_with({{"noise", "0.2"}, {"bias", "0.5"}}, 10);
  double sum = 0;
  double squares = 0;
  constexpr int kUpdates = 2000;
  for (int i = 0; i < kUpdates; ++i) {
    node.set_input(std::vector<double>(10, 1.0));
    node.step(kMs);
    for (const double value : node.output()) {
      sum += value;
      squares += (value - 1.5) * (value - 1.5);
    }
  }
  const double n = 10.0 * kUpdates;
  EXPECT_NEAR(sum / n, 1.5, 4 * 0.2 / std::sqrt(n));
  EXPECT_NEAR(std::sqrt(squares / n), 0.2, 4 * 0.2 / std::sqrt(2 * n));
}

TEST(DisturbSignal, ActsFromItsBeginToItsEndWhateverTheInputDoes) {
  NodeHarness node = signal_with({{"bias", "1"}, {"from", "10 ms"}, {"to", "20 ms"}});
  node.set_input({0.25});
  node.run_until(10 * kMs, kMs);
  EXPECT_EQ(node.output()[0], 0.25);
  node.step(kMs);
  EXPECT_EQ(node.output()[0], 1.25);
  node.run_until(20 * kMs, kMs);
  EXPECT_EQ(node.output()[0], 1.25);
  node.step(kMs);
  EXPECT_EQ(node.output()[0], 0.25);
  EXPECT_EQ(node.counter("updates"), 3U);
}

TEST(DisturbSignal, FrozenItKeepsItsValueAndThenHasTheNewestOne) {
  NodeHarness node = signal_with({{"freeze", "true"}, {"from", "5 ms"}, {"to", "10 ms"}});
  for (int i = 1; i <= 12; ++i) {
    node.set_input({static_cast<double>(i)});
    node.step(kMs);
    EXPECT_EQ(node.output()[0], i > 5 && i <= 10 ? 5 : i) << i;
  }
}

TEST(DisturbSignal, LostValuesLeaveTheOldOnes) {
  NodeHarness node = signal_with({{"drop", "0.4"}}, 10);
  std::size_t old = 0;
  std::vector<double> last(10, 0);
  for (int i = 1; i <= 2000; ++i) {
    node.set_input(std::vector<double>(10, i));
    node.step(kMs);
    for (std::size_t c = 0; c < 10; ++c) {
      old += node.output()[c] == last[c] ? 1 : 0;
      ASSERT_TRUE(node.output()[c] == last[c] || node.output()[c] == i);
    }
    last = node.output();
  }
  EXPECT_EQ(old, node.counter("dropped"));
  EXPECT_NEAR(static_cast<double>(old), 8000, 4 * std::sqrt(20'000 * 0.4 * 0.6));
}

TEST(DisturbSignal, AChangedBiasHoldsForTheValueThatIsThere) {
  NodeHarness node = signal_with({});
  node.set_input({1});
  node.step(kMs);
  node.change("bias", 0.5);
  node.step(kMs);
  EXPECT_EQ(node.output()[0], 1.5);
  const auto revision = node.revision();
  node.step(kMs);
  EXPECT_EQ(node.revision(), revision) << "nothing has changed";
}

TEST(DisturbSignal, WithoutAValueHasNone) {
  NodeHarness node = signal_with({{"bias", "1"}});
  node.step(kMs);
  EXPECT_EQ(node.revision(), 0U);
  node.set_input({1});
  node.step(kMs);
  EXPECT_EQ(node.output()[0], 2);
  node.invalidate_input();
  node.step(kMs);
  EXPECT_EQ(node.revision(), 0U);
}

}  // namespace
}  // namespace spikeloop::testing
