// When each channel of an encoder fires next. A channel spikes when the integral of its rate since
// the last spike reaches a threshold: 1 for regular spikes, a unit exponential draw for a Poisson
// process (time rescaling, Brown et al. 2002). The rate is piecewise constant, so the time of the
// next spike is known in closed form from the latest change of rate or spike; between these nothing
// is computed. What is left of the integral is carried over every change of rate, also to and from
// 0: no spike is lost, doubled, or due at a time that is not a number.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "due_blocks.hpp"
#include "large_array.hpp"
#include "schedule_kernels.hpp"
#include "spikeloop/core/node.hpp"
#include "spikeloop/core/signal.hpp"
#include "spikeloop/core/time.hpp"

namespace spikeloop {

class SpikeSchedule {
 public:
  /// Above it, rates are cut: the stamps' resolution is 1 ns.
  static constexpr double kFastest = 1e6;  // Hz
  /// Below it (one spike in three years), a rate counts as 0, so that every spike time is finite.
  static constexpr double kSlowest = 1e-8;  // Hz

  /// Every channel has rate 0 and a threshold of 1 before it.
  explicit SpikeSchedule(std::uint32_t channels) : SpikeSchedule({}, channels) {}
  /// Of a share of them: channel c of the schedule is channel first() + c of the output.
  SpikeSchedule(const Share& share, std::uint32_t channels);

  /// What the integral of the rate must reach before the first spike; only while the rate is 0.
  void set_first_threshold(std::uint32_t channel, double threshold) {
    state_of(channel) = threshold * kSpike;
  }

  /// From `now` on, channel c has the rate  offset + slope * x  in Hz, cut to [0, kFastest], where
  /// x is values[c] after `treat(part of the values, its first channel)`, which
  /// leaves values within `usual` as they are; NaN: as it was. Spikes up to `now` have been taken.
  template <typename Treat>
  void set_rates(TimeNs now, std::span<const double> values, double offset, double slope,
                 double usual, Treat&& treat) {
    ScheduleChange change = change_at(static_cast<double>(now - since_));
    change.offset = offset;
    change.slope = slope;
    change.values = values.data();
    if (!changes_a_rate(change) && all_within(values, usual)) {
      return;
    }
    // Part by part, so that values which `treat` has looked at are still in a cache.
    constexpr std::size_t kPart = 256 * kBlock;
    for (std::size_t first = 0; first < channels_; first += kPart) {
      const auto part = values.subspan(first, std::min(kPart, channels_ - first));
      change.blocks = &blocks_[first / kBlock];
      change.earliest = &earliest_[first / kBlock];
      change.channels = part.size();
      change.values = treat(part, first).data();
      change_rates(change);
    }
    since_ = now;
  }
  /// From `now` on, channel c has the rate `rate_of(c)` in Hz.
  template <typename RateOf>
  void set_rates(TimeNs now, RateOf&& rate_of) {
    rates_.resize(channels_);
    for (std::uint32_t c = 0; c < channels_; ++c) {
      rates_[c] = rate_of(c);
    }
    set_rates(now, rates_, 0, 1, kNeverDue, [](auto part, std::size_t) { return part; });
  }

  /// Emits the spikes of `interval` to `output`. Of each spike's channel, `thresholds(channels,
  /// next)` writes the threshold of the next one. Returns the number of spikes.
  template <typename Thresholds>
  std::uint64_t advance(const Interval& interval, Thresholds&& thresholds,
                        const SpikeOutput& output) {
    std::uint64_t count = 0;
    while (interval.end - since_ > kLongest) {
      count += fire(kLongest, thresholds, output);
      shift(kLongest);
    }
    return count + fire(interval.end - since_, thresholds, output);
  }

  std::uint32_t channels() const { return channels_; }
  std::uint32_t first() const { return first_; }

 private:
  static constexpr double kSpike = 1e9;  // an integral of 1, in Hz ns
  // Times count from a new zero after about a second, so that they keep the precision of 1e-6 ns.
  static constexpr TimeNs kLongest = TimeNs{1} << 30;

  template <typename Thresholds>
  std::uint64_t fire(TimeNs end, Thresholds&& thresholds, const SpikeOutput& output) {
    const auto limit = static_cast<double>(end);
    const std::size_t due = find_due(earliest_.data(), earliest_.size(), limit, due_.data());
    std::uint64_t count = 0;
    for (std::size_t i = 0; i < due; i += kMostBlocks) {
      std::span<std::uint32_t> blocks(&due_[i], std::min(kMostBlocks, due - i));
      while (!blocks.empty()) {
        collect_due(blocks_.data(), blocks, limit, firing_);
        thresholds(std::span(firing_.channels, firing_.count), std::span(next_, firing_.count));
        restart();
        emit(output);
        count += firing_.count;
        blocks = blocks.first(keep_due(blocks_.data(), blocks, limit, earliest_.data()));
      }
    }
    return count;
  }

  double& state_of(std::uint32_t channel) {
    return blocks_[channel / kBlock].state[channel % kBlock];
  }

  ScheduleChange change_at(double passed);
  void shift(TimeNs passed);
  void restart();
  void emit(const SpikeOutput& output);

  std::uint32_t first_;
  std::uint32_t channels_;
  LargeArray<ScheduleBlock> blocks_;  // 16 bytes a channel
  LargeArray<float> earliest_;        // of each block: a time not later than its first spike
  TimeNs since_ = 0;                  // the latest change
  std::vector<std::uint32_t> due_;
  ScheduleFiring firing_;
  double next_[kMostBlocks * kBlock] = {};  // thresholds
  std::vector<double> rates_;
  std::vector<Spike> emitted_;
};

}  // namespace spikeloop
