// The inner loops of a spike schedule, for every instruction set with the same results to the bit.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>

#include "due_blocks.hpp"

namespace spikeloop {

/// Eight channels. Times count from the latest change of a rate, in ns.
struct alignas(64) ScheduleBlock {
  double rate[kBlock];  ///< Hz
  /// rate > 0: when the integral of the rate reaches the threshold; rate 0: what is left of the
  /// integral till then, in 1e-9 spikes.
  double state[kBlock];
};

/// Times are rounded to 1e-6 ns (the far future coarser), so that counting them from another zero
/// changes no bit: then spikes do not depend on how often an input is said to be new, nor on how
/// the channels are shared out. x + m - m rounds x; this is the m for a time `wait` after another.
inline double schedule_rounding(double wait) {
  return wait < 0x1p31 ? 0x1.8p32 : wait < 0x1p41 ? 0x1.8p42 : 0x1.8p52;
}
inline double round_by(double time, double magic) {
  return (time + magic) - magic;
}

/// Which rates the channels have from now on.
struct ScheduleChange {
  ScheduleBlock* blocks;
  float* earliest;  ///< of each block: a time not later than its first spike
  std::size_t channels;
  double passed;  ///< since the change before
  /// A channel's rate is  offset + slope * values[c], cut to [0, highest], and 0 below `slowest`;
  /// where that is NaN, it stays. Null: all stay.
  const double* values = nullptr;
  double offset = 0;
  double slope = 1;
  double slowest;
  double highest;
};
/// Whether any rate would change, or a value is NaN.
bool changes_a_rate(const ScheduleChange& change);
void change_rates(const ScheduleChange& change);

/// Whether |value| is at most `limit` for all.
bool all_within(std::span<const double> values, double limit);

/// -ln x, to 2 units in the last place, for normal x > 0.
void negative_logarithms(std::span<double> values);

/// The spikes of some blocks up to `limit`, at most one a channel.
struct ScheduleFiring {
  std::size_t count = 0;
  std::uint32_t channels[kMostBlocks * kBlock] = {};
  double stamps[kMostBlocks * kBlock] = {};
};
void collect_due(const ScheduleBlock* blocks, std::span<const std::uint32_t> due, double limit,
                 ScheduleFiring& firing);
/// Renews `earliest` of the listed blocks. Returns how many have more spikes, which are put first.
std::size_t keep_due(const ScheduleBlock* blocks, std::span<std::uint32_t> due, double limit,
                     float* earliest);

}  // namespace spikeloop
