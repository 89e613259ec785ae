#include "spike_sort.hpp"

#include <algorithm>
#include <bit>
#include <utility>

namespace spikeloop {
namespace {

/// Below, comparing is faster.
constexpr std::size_t kFew = 64;
/// Of a pass: its counters and the ends of its 2048 lists stay in the second cache.
constexpr int kMostBits = 11;

/// An object is inlined by std::sort, a function is not.
struct Before {
  bool operator()(const Spike& a, const Spike& b) const {
    return a.time_ns < b.time_ns || (a.time_ns == b.time_ns && a.channel < b.channel);
  }
};

int bits_of(std::uint64_t largest) {
  return static_cast<int>(std::bit_width(largest));
}

/// By channel, as an unsigned number that orders negative ones first.
std::uint64_t channel_key(const Spike& spike) {
  return static_cast<std::uint32_t>(spike.channel) ^ 0x80000000U;
}

}  // namespace

/// Stable, by key(spike), which has that many bits, from its last bits on. Returns where they are
/// then: in `spikes` or in `other`, which is as long.
template <typename Key>
std::span<Spike> SpikeSorter::by_key(std::span<Spike> spikes, std::span<Spike> other, int bits,
                                     Key&& key) {
  const int passes = (bits + kMostBits - 1) / kMostBits;
  for (int pass = 0; pass < passes; ++pass) {
    const int first = bits * pass / passes;
    const int width = bits * (pass + 1) / passes - first;
    const std::uint64_t mask = (std::uint64_t{1} << width) - 1;
    const auto digit = [&](const Spike& spike) { return (key(spike) >> first) & mask; };
    counts_.assign(std::size_t{1} << width, 0);
    for (const Spike& spike : spikes) {
      ++counts_[digit(spike)];
    }
    std::size_t place = 0;
    for (std::size_t& count : counts_) {
      place += std::exchange(count, place);
    }
    for (const Spike& spike : spikes) {
      other[counts_[digit(spike)]++] = spike;
    }
    std::swap(spikes, other);
  }
  return spikes;
}

/// Spikes of one key stand together, in the order in which they came.
template <typename Key>
void SpikeSorter::finish_groups(std::span<Spike> spikes, std::span<Spike> other, Key&& key) {
  for (std::size_t begin = 0; begin < spikes.size();) {
    const std::uint64_t here = key(spikes[begin]);
    bool in_order = true;
    std::size_t end = begin + 1;
    for (; end < spikes.size() && key(spikes[end]) == here; ++end) {
      in_order = in_order && !Before{}(spikes[end], spikes[end - 1]);
    }
    if (!in_order) {
      sort_group(spikes.subspan(begin, end - begin), other.subspan(begin, end - begin));
    }
    begin = end;
  }
}

/// Many spikes of one time differ in their channels alone: simulators and NEF neurons have a grid.
void SpikeSorter::sort_group(std::span<Spike> spikes, std::span<Spike> other) {
  const auto other_time = [&](const Spike& spike) {
    return spike.time_ns != spikes.front().time_ns;
  };
  if (spikes.size() < kFew || std::ranges::any_of(spikes, other_time)) {
    std::sort(spikes.begin(), spikes.end(), Before{});
    return;
  }
  const auto [least, most] = std::ranges::minmax(spikes, {}, channel_key);
  const std::uint64_t lowest = channel_key(least);
  const auto sorted = by_key(spikes, other, bits_of(channel_key(most) - lowest),
                             [lowest](const Spike& spike) { return channel_key(spike) - lowest; });
  if (sorted.data() != spikes.data()) {
    std::ranges::copy(sorted, spikes.begin());
  }
}

void SpikeSorter::sort(std::vector<Spike>& spikes) {
  if (std::is_sorted(spikes.begin(), spikes.end(), Before{})) {
    return;
  }
  if (spikes.size() < kFew) {
    std::sort(spikes.begin(), spikes.end(), Before{});
    return;
  }
  const auto [least, most] = std::ranges::minmax(spikes, {}, &Spike::time_ns);
  const auto first = static_cast<std::uint64_t>(least.time_ns);
  const int all = bits_of(static_cast<std::uint64_t>(most.time_ns) - first);
  // So many that most groups have one spike.
  const int bits = std::min(all, bits_of(spikes.size()) + 1);
  const auto key = [first, drop = all - bits](const Spike& spike) {
    return (static_cast<std::uint64_t>(spike.time_ns) - first) >> drop;
  };
  other_.resize(spikes.size());
  const auto sorted = by_key(spikes, other_, bits, key);
  if (sorted.data() != spikes.data()) {
    spikes.swap(other_);
  }
  finish_groups(spikes, other_, key);
}

}  // namespace spikeloop
