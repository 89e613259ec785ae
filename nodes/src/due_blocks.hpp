// Which of many blocks of neurons have a spike in an interval: of each block a number is kept, not
// later than its first spike. Single precision halves what is read in every tick.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

namespace spikeloop {

inline constexpr std::size_t kBlock = 8;  ///< neurons or channels that are computed together
inline constexpr double kNeverDue = std::numeric_limits<double>::infinity();
/// Blocks whose spikes are taken at once: they stay in the second cache meanwhile.
inline constexpr std::size_t kMostBlocks = 512;
/// So many blocks ahead memory is asked for.
inline constexpr std::size_t kAhead = 32;

/// The number to keep for a block whose first spike is due at `time` > 0; infinity stays.
inline float not_later_than(double time) {
  constexpr double kAnUlpLess = 1 - 0x1p-22;
  return static_cast<float>(time * kAnUlpLess);
}

/// Writes the blocks whose number is at most `limit` to `due`, which has `count` places; returns
/// how many there are.
std::size_t find_due(const float* earliest, std::size_t count, double limit, std::uint32_t* due);

}  // namespace spikeloop
