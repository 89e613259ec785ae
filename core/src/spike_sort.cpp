#include "spike_sort.hpp"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <utility>

namespace spikeloop {
namespace {

/// Below, comparing is faster.
constexpr std::size_t kFew = 20;
/// Of one deal: its counters and the ends of its 2048 lists stay in the second cache.
constexpr int kMostBits = 11;

/// An object is inlined by std::sort, a function is not.
struct Before {
  bool operator()(const Spike& a, const Spike& b) const {
    return a.time_ns < b.time_ns || (a.time_ns == b.time_ns && a.channel < b.channel);
  }
};

/// As an unsigned number, in which negative channels come first.
std::uint64_t unsigned_channel(const Spike& spike) {
  return static_cast<std::uint32_t>(spike.channel) ^ 0x80000000U;
}

}  // namespace

/// Stable; digit(spike) has that many bits.
template <typename Digit>
void SpikeSorter::deal(std::span<const Spike> from, std::span<Spike> to, int bits, Digit&& digit) {
  counts_.assign(std::size_t{1} << bits, 0);
  for (const Spike& spike : from) {
    ++counts_[digit(spike)];
  }
  std::size_t place = 0;
  for (std::size_t& count : counts_) {
    place += std::exchange(count, place);
  }
  for (const Spike& spike : from) {
    to[counts_[digit(spike)]++] = spike;
  }
}

/// By the leading bits of the time; then, within a cache, what shares them. Returns whether they
/// are in `other` then, which is as long.
bool SpikeSorter::order(std::span<Spike> spikes, std::span<Spike> other) {
  if (spikes.size() < kFew) {
    std::sort(spikes.begin(), spikes.end(), Before{});
    return false;
  }
  const auto [earliest, latest] = std::ranges::minmax(spikes, {}, &Spike::time_ns);
  if (earliest.time_ns == latest.time_ns) {
    return order_by_channel(spikes, other);
  }
  const auto first = static_cast<std::uint64_t>(earliest.time_ns);
  const auto all =
      static_cast<int>(std::bit_width(static_cast<std::uint64_t>(latest.time_ns) - first));
  const int bits = std::min({all, kMostBits, static_cast<int>(std::bit_width(spikes.size())) + 1});
  const auto digit = [first, drop = all - bits](const Spike& spike) {
    return (static_cast<std::uint64_t>(spike.time_ns) - first) >> drop;
  };
  deal(spikes, other, bits, digit);
  for (std::size_t begin = 0; begin < other.size();) {
    const std::uint64_t here = digit(other[begin]);
    bool in_order = true;
    std::size_t end = begin + 1;
    for (; end < other.size() && digit(other[end]) == here; ++end) {
      in_order = in_order && !Before{}(other[end], other[end - 1]);
    }
    const auto group = other.subspan(begin, end - begin);
    const auto rest = spikes.subspan(begin, end - begin);
    if (!in_order && order(group, rest)) {
      std::ranges::copy(rest, group.begin());
    }
    begin = end;
  }
  return true;
}

/// Spikes of one time, of which simulators and NEF neurons have many: they have a grid.
bool SpikeSorter::order_by_channel(std::span<Spike> spikes, std::span<Spike> other) {
  const auto [least, most] = std::ranges::minmax(spikes, {}, unsigned_channel);
  const std::uint64_t lowest = unsigned_channel(least);
  const auto all = static_cast<int>(std::bit_width(unsigned_channel(most) - lowest));
  const int passes = (all + kMostBits - 1) / kMostBits;
  for (int pass = 0; pass < passes; ++pass) {  // from the last bits on
    const int drop = all * pass / passes;
    const int bits = all * (pass + 1) / passes - drop;
    const std::uint64_t mask = (std::uint64_t{1} << bits) - 1;
    deal(spikes, other, bits,
         [=](const Spike& spike) { return ((unsigned_channel(spike) - lowest) >> drop) & mask; });
    std::swap(spikes, other);
  }
  return passes % 2 == 1;
}

void SpikeSorter::sort(std::vector<Spike>& spikes) {
  if (std::is_sorted(spikes.begin(), spikes.end(), Before{})) {
    return;
  }
  other_.resize(spikes.size());
  if (order(spikes, other_)) {
    spikes.swap(other_);
  }
}

}  // namespace spikeloop
