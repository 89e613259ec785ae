// Which of many blocks of neurons have a spike in an interval: of each block a number is kept, not
// later than its first spike. Single precision halves what is read in every tick.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

namespace spikeloop {

/// The number to keep for a block whose first spike is due at `time` > 0; infinity stays.
inline float not_later_than(double time) {
  constexpr double kAnUlpLess = 1 - 0x1p-22;
  return static_cast<float>(time * kAnUlpLess);
}

/// Writes the blocks whose number is at most `limit` to `due`, which has `count` places; returns
/// how many there are.
std::size_t find_due(const float* earliest, std::size_t count, double limit, std::uint32_t* due);

}  // namespace spikeloop
