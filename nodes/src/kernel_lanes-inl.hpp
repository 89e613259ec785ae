// What all kernels on blocks of eight channels have in common.
#if defined(SPIKELOOP_NODES_KERNEL_LANES_INL_HPP) == defined(HWY_TARGET_TOGGLE)
#ifdef SPIKELOOP_NODES_KERNEL_LANES_INL_HPP
#undef SPIKELOOP_NODES_KERNEL_LANES_INL_HPP
#else
#define SPIKELOOP_NODES_KERNEL_LANES_INL_HPP
#endif

#include <hwy/highway.h>

#include <cstdint>

#include "due_blocks.hpp"
#include "vector_math-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace spikeloop::HWY_NAMESPACE {

using Lanes = hn::CappedTag<double, kBlock>;
using Vector = hn::Vec<Lanes>;
using Mask = hn::Mask<Lanes>;

HWY_INLINE Vector set(double value) {
  return hn::Set(Lanes(), value);
}

/// The nearest nanosecond after 0.
HWY_INLINE Vector nearest_stamp(Vector time) {
  return hn::Max(hn::Floor(hn::Add(time, set(0.5))), set(1.0));
}

/// Bit i says whether the time of lane i is at most `limit`.
HWY_INLINE unsigned bits_at_most(Vector time, double limit) {
  const Lanes d;
  std::uint8_t bits[8] = {};  // as many as StoreMaskBits may write
  hn::StoreMaskBits(d, hn::Le(time, set(limit)), bits);
  return bits[0];
}

}  // namespace spikeloop::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
