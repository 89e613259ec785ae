// When each channel of an encoder fires next. A channel spikes when the integral of its rate since
// the last spike reaches a threshold: 1 for regular spikes, a unit exponential draw for a Poisson
// process (time rescaling, Brown et al. 2002). The rate is piecewise constant, so the time of the
// next spike is known in closed form from the latest change of rate or spike; between these nothing
// is computed. What is left of the integral is carried over every change of rate, also to and from
// 0: no spike is lost, doubled, or due at a time that is no number.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

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
  explicit SpikeSchedule(std::uint32_t channels);

  /// What the integral of the rate must reach before the first spike; only while the rate is 0.
  void set_first_threshold(std::uint32_t channel, double threshold) { rest_[channel] = threshold; }

  /// From `now` on, channel c has the rate `rate_of(c)` in Hz, in [0, kFastest]; NaN: as it was.
  template <typename RateOf>
  void set_rates(TimeNs now, RateOf&& rate_of) {
    for (std::size_t block = 0; block < earliest_.size(); ++block) {
      const std::uint32_t first = static_cast<std::uint32_t>(block) * kBlock;
      const std::uint32_t last = std::min(first + kBlock, channels());
      for (std::uint32_t c = first; c < last; ++c) {
        const double wanted = rate_of(c);
        const double rate = wanted < kSlowest ? 0.0 : wanted;
        // An equal rate must not begin a new segment: rounding would depend on revisions.
        if (rate != rate_[c] && !std::isnan(rate)) {
          change_rate(c, rate, now);
        }
      }
      earliest_[block] = *std::min_element(next_.begin() + first, next_.begin() + last);
    }
  }

  /// Emits the spikes of `interval` to `output`; `threshold_of(c)` is asked once a spike for the
  /// threshold of the next one. Returns the number of spikes.
  template <typename ThresholdOf>
  std::uint64_t advance(const Interval& interval, ThresholdOf&& threshold_of,
                        const SpikeOutput& output) {
    std::uint64_t count = 0;
    for (std::size_t block = 0; block < earliest_.size(); ++block) {
      if (earliest_[block] <= interval.end) {
        advance_block(block, interval.end, threshold_of);
        count += emitted_.size();
        output.emit(emitted_);
        emitted_.clear();
      }
    }
    return count;
  }

  std::uint32_t channels() const { return static_cast<std::uint32_t>(rate_.size()); }

 private:
  static constexpr TimeNs kNever = std::numeric_limits<TimeNs>::max();
  static constexpr std::uint32_t kBlock = 16;

  void change_rate(std::uint32_t channel, double rate, TimeNs now);

  // The next spike is due `wait` ns after `from`. It is stamped with the nearest nanosecond after
  // `from`; the difference is kept, so that rounding never adds up.
  void set_due(std::uint32_t channel, TimeNs from, double wait) {
    const TimeNs whole = std::max<TimeNs>(1, static_cast<TimeNs>(wait + 0.5));
    next_[channel] = from + whole;
    rest_[channel] = wait - static_cast<double>(whole);
  }

  template <typename ThresholdOf>
  void advance_block(std::size_t block, TimeNs end, ThresholdOf&& threshold_of) {
    const std::uint32_t first = static_cast<std::uint32_t>(block) * kBlock;
    const std::uint32_t last = std::min(first + kBlock, channels());
    TimeNs earliest = kNever;
    for (std::uint32_t c = first; c < last; ++c) {
      while (next_[c] <= end) {
        emitted_.push_back(make_spike(next_[c], static_cast<std::int32_t>(c)));
        set_due(c, next_[c], rest_[c] + threshold_of(c) * 1e9 / rate_[c]);
      }
      earliest = std::min(earliest, next_[c]);
    }
    earliest_[block] = earliest;
  }

  // 24 bytes a channel.
  std::vector<double> rate_;      // Hz
  std::vector<TimeNs> next_;      // stamp of the next spike; kNever while the rate is 0
  std::vector<double> rest_;      // rate > 0: its exact time minus next_, ns; rate 0: integral left
  std::vector<TimeNs> earliest_;  // per block of channels: the smallest next_
  std::vector<Spike> emitted_;
};

}  // namespace spikeloop
