// The radix sort of a tick's spikes, beside std::sort.
#include "core/src/spike_sort.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <functional>
#include <limits>
#include <random>
#include <vector>

namespace spikeloop {
namespace {

bool same(const Spike& a, const Spike& b) {
  return a.time_ns == b.time_ns && a.channel == b.channel;
}

void expect_sorted(SpikeSorter& sorter, std::vector<Spike> spikes) {
  std::vector<Spike> expected = spikes;
  std::sort(expected.begin(), expected.end(), spike_before);
  sorter.sort(spikes);
  ASSERT_EQ(spikes.size(), expected.size());
  const auto [ours, theirs] =
      std::mismatch(spikes.begin(), spikes.end(), expected.begin(), expected.end(), same);
  EXPECT_TRUE(ours == spikes.end()) << "spike " << ours - spikes.begin() << " of " << spikes.size();
}

/// As many spikes with times and channels of these.
using Draw = std::function<std::int64_t(std::mt19937_64&)>;
std::vector<Spike> drawn(std::size_t count, const Draw& time, const Draw& channel) {
  std::mt19937_64 generator(count);
  std::vector<Spike> spikes(count);
  for (Spike& spike : spikes) {
    spike = make_spike(time(generator), static_cast<std::int32_t>(channel(generator)));
  }
  return spikes;
}

Draw between(std::int64_t least, std::int64_t most) {
  return [=](std::mt19937_64& generator) {
    return std::uniform_int_distribution<std::int64_t>(least, most)(generator);
  };
}

constexpr std::size_t kCounts[] = {0, 1, 2, 19, 20, 21, 64, 1000, 5000, 60'000};

TEST(SpikeSort, OfRandomTimes) {
  SpikeSorter sorter;  // one for all: it keeps its memory
  for (const std::size_t count : kCounts) {
    expect_sorted(sorter, drawn(count, between(1, 50'000'000), between(0, 49'999)));
    expect_sorted(sorter, drawn(count, between(1, 1'000'000), between(0, 9)));
  }
}

TEST(SpikeSort, OfTimesOnAGrid) {
  SpikeSorter sorter;
  const auto on_grid = [](std::mt19937_64& generator) {
    return 1'000'000 * std::uniform_int_distribution<std::int64_t>(1, 50)(generator);
  };
  for (const std::size_t count : kCounts) {
    expect_sorted(sorter, drawn(count, on_grid, between(0, 999'999)));
    expect_sorted(sorter, drawn(count, between(7, 7), between(0, 999'999)));
    expect_sorted(sorter, drawn(count, between(7, 8), between(0, 3)));
  }
}

TEST(SpikeSort, OfAllNumbersThereAre) {
  SpikeSorter sorter;
  constexpr auto kLongest = std::numeric_limits<TimeNs>::max();
  constexpr auto kChannels = std::numeric_limits<std::int32_t>::max();
  for (const std::size_t count : kCounts) {
    expect_sorted(sorter, drawn(count, between(-kLongest - 1, kLongest),
                                between(-std::int64_t{kChannels} - 1, kChannels)));
    expect_sorted(sorter, drawn(count, between(-5, 5), between(-5, 5)));
  }
}

// What crowds in a corner of the interval shares its leading bits.
TEST(SpikeSort, OfCrowdsAndStrays) {
  SpikeSorter sorter;
  const auto crowded = [](std::mt19937_64& generator) -> std::int64_t {
    return generator() % 1000 == 0 ? 50'000'000 : static_cast<std::int64_t>(generator() % 500);
  };
  for (const std::size_t count : kCounts) {
    expect_sorted(sorter, drawn(count, crowded, between(0, 100)));
  }
}

// Volleys, as encoders emit them: part by part of the channels, round by round.
TEST(SpikeSort, OfVolleys) {
  SpikeSorter sorter;
  std::vector<Spike> spikes;
  for (int part = 0; part < 10; ++part) {
    for (int round = 1; round <= 20; ++round) {
      for (int channel = 0; channel < 400; ++channel) {
        spikes.push_back(make_spike(round * 1'250'000, part * 400 + channel));
      }
    }
  }
  expect_sorted(sorter, spikes);
  std::ranges::reverse(spikes);
  expect_sorted(sorter, spikes);
}

}  // namespace
}  // namespace spikeloop
