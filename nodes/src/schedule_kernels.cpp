#include "schedule_kernels.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "vector_targets.hpp"
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "schedule_kernels.cpp"
#include <hwy/cache_control.h>
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "kernel_lanes-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace spikeloop::HWY_NAMESPACE {

/// When channels fire.
HWY_INLINE Vector stamp_of(Vector rate, Vector state) {
  return hn::IfThenElse(hn::Gt(rate, set(0.0)), nearest_stamp(state), set(kNeverDue));
}

/// schedule_rounding() and round_by().
HWY_INLINE Vector rounded(Vector wait) {
  const Vector far = hn::IfThenElse(hn::Lt(wait, set(0x1p41)), set(0x1.8p42), set(0x1.8p52));
  const Vector magic = hn::IfThenElse(hn::Lt(wait, set(0x1p31)), set(0x1.8p32), far);
  return hn::Sub(hn::Add(wait, magic), magic);
}

HWY_INLINE Vector new_rate(Vector value, Vector old, const ScheduleChange& change) {
  const Lanes d;
  Vector rate = fused(d, set(change.slope), value, set(change.offset));
  const auto is_number = hn::Eq(rate, rate);
  rate = hn::Min(hn::Max(rate, set(0.0)), set(change.highest));
  rate = hn::IfThenElse(hn::Lt(rate, set(change.slowest)), set(0.0), rate);
  return hn::IfThenElse(is_number, rate, old);
}

/// A block's values; the last block may have fewer than eight.
HWY_INLINE const double* values_of(const ScheduleChange& change, std::size_t block,
                                   double* padded) {
  const std::size_t first = block * kBlock;
  if (change.values == nullptr) {
    std::fill_n(padded, kBlock, std::nan(""));
    return padded;
  }
  if (first + kBlock <= change.channels) {
    return change.values + first;
  }
  std::fill_n(padded, kBlock, std::nan(""));
  std::copy(change.values + first, change.values + change.channels, padded);
  return padded;
}

bool changes_a_rate(const ScheduleChange& change) {
  const Lanes d;
  const std::size_t blocks = (change.channels + kBlock - 1) / kBlock;
  double padded[kBlock];
  for (std::size_t b = 0; b < blocks; ++b) {
    const double* const values = values_of(change, b, padded);
    const bool whole = values != padded;
    for (std::size_t lane = 0; lane < kBlock; lane += hn::Lanes(d)) {
      const Vector old = hn::Load(d, change.blocks[b].rate + lane);
      const Vector value = hn::LoadU(d, values + lane);
      const auto equal = hn::Eq(new_rate(value, old, change), old);
      if (!hn::AllTrue(d, equal) || (whole && !hn::AllTrue(d, hn::Eq(value, value)))) {
        return true;
      }
    }
  }
  const std::size_t rest = change.channels % kBlock;
  return std::any_of(change.values + (change.channels - rest), change.values + change.channels,
                     [](double value) { return std::isnan(value); });
}

void change_rates(const ScheduleChange& change) {
  const Lanes d;
  const std::size_t blocks = (change.channels + kBlock - 1) / kBlock;
  double padded[kBlock];
  for (std::size_t b = 0; b < blocks; ++b) {
    ScheduleBlock& block = change.blocks[b];
    const double* const values = values_of(change, b, padded);
    Vector least = set(kNeverDue);
    for (std::size_t lane = 0; lane < kBlock; lane += hn::Lanes(d)) {
      const Vector old = hn::Load(d, block.rate + lane);
      const Vector state = hn::Load(d, block.state + lane);
      const Vector rate = new_rate(hn::LoadU(d, values + lane), old, change);
      const auto ran = hn::Gt(old, set(0.0));
      const auto runs = hn::Gt(rate, set(0.0));
      const Vector wait = hn::Max(hn::Sub(state, set(change.passed)), set(0.0));
      const Vector left = hn::IfThenElse(ran, hn::Mul(wait, old), state);
      Vector next = hn::IfThenElse(runs, rounded(hn::Div(left, rate)), left);
      next = hn::IfThenElse(hn::And(ran, hn::Eq(rate, old)), wait, next);
      hn::Store(rate, d, block.rate + lane);
      hn::Store(next, d, block.state + lane);
      least = hn::Min(least, stamp_of(rate, next));
    }
    change.earliest[b] = not_later_than(hn::GetLane(hn::MinOfLanes(d, least)));
  }
}

bool all_within(std::span<const double> values, double limit) {
  const Lanes d;
  const std::size_t whole = values.size() - values.size() % kBlock;
  for (std::size_t i = 0; i < whole; i += hn::Lanes(d)) {
    // False for NaN.
    if (!hn::AllTrue(d, hn::Le(hn::Abs(hn::LoadU(d, values.data() + i)), set(limit)))) {
      return false;
    }
  }
  return std::ranges::all_of(values.subspan(whole),
                             [&](double value) { return std::fabs(value) <= limit; });
}

void negative_logarithms(std::span<double> values) {
  const Lanes d;
  const std::size_t whole = values.size() - values.size() % hn::Lanes(d);
  for (std::size_t i = 0; i < whole; i += hn::Lanes(d)) {
    hn::StoreU(hn::Neg(logarithm(d, hn::LoadU(d, values.data() + i))), d, values.data() + i);
  }
  const hn::CappedTag<double, 1> one;
  for (std::size_t i = whole; i < values.size(); ++i) {
    const auto logs = logarithm(one, hn::Set(one, values[i]));
    values[i] = -hn::GetLane(logs);
  }
}

void collect_due(const ScheduleBlock* blocks, std::span<const std::uint32_t> due, double limit,
                 ScheduleFiring& firing) {
  const Lanes d;
  firing.count = 0;
  for (std::size_t i = 0; i < due.size(); ++i) {
    const ScheduleBlock& later = blocks[due[std::min(i + kAhead, due.size() - 1)]];
    hwy::Prefetch(later.rate);
    hwy::Prefetch(later.state);
    const ScheduleBlock& block = blocks[due[i]];
    alignas(64) double stamps[kBlock];
    unsigned fires = 0;
    for (std::size_t lane = 0; lane < kBlock; lane += hn::Lanes(d)) {
      const Vector stamp =
          stamp_of(hn::Load(d, block.rate + lane), hn::Load(d, block.state + lane));
      hn::Store(stamp, d, stamps + lane);
      fires |= bits_at_most(stamp, limit) << lane;
    }
    for (; fires != 0; fires &= fires - 1) {
      const auto lane = static_cast<std::uint32_t>(std::countr_zero(fires));
      firing.channels[firing.count] = due[i] * static_cast<std::uint32_t>(kBlock) + lane;
      firing.stamps[firing.count] = stamps[lane];
      ++firing.count;
    }
  }
}

std::size_t keep_due(const ScheduleBlock* blocks, std::span<std::uint32_t> due, double limit,
                     float* earliest) {
  const Lanes d;
  std::size_t kept = 0;
  for (const std::uint32_t index : due) {
    const ScheduleBlock& block = blocks[index];
    Vector least = set(kNeverDue);
    for (std::size_t lane = 0; lane < kBlock; lane += hn::Lanes(d)) {
      least =
          hn::Min(least, stamp_of(hn::Load(d, block.rate + lane), hn::Load(d, block.state + lane)));
    }
    const double first = hn::GetLane(hn::MinOfLanes(d, least));
    earliest[index] = not_later_than(first);
    due[kept] = index;
    kept += first <= limit ? 1 : 0;
  }
  return kept;
}

std::size_t find_due(const float* earliest, std::size_t count, double limit, std::uint32_t* due) {
  const hn::ScalableTag<float> d;
  const hn::RebindToUnsigned<decltype(d)> indices;
  const std::size_t lanes = hn::Lanes(d);
  const std::size_t whole = count - count % lanes;
  const float most = std::nextafter(static_cast<float>(limit), std::numeric_limits<float>::max());
  std::size_t found = 0;
  auto index = hn::Iota(indices, 0);
  // No branches: they would be mispredicted. What is written beyond `found` is overwritten.
  for (std::size_t first = 0; first < whole; first += lanes) {
    const auto is_due = hn::Le(hn::LoadU(d, earliest + first), hn::Set(d, most));
    hn::StoreU(hn::Compress(index, hn::RebindMask(indices, is_due)), indices, due + found);
    found += hn::CountTrue(d, is_due);
    index = hn::Add(index, hn::Set(indices, static_cast<std::uint32_t>(lanes)));
  }
  for (std::size_t b = whole; b < count; ++b) {
    due[found] = static_cast<std::uint32_t>(b);
    found += earliest[b] <= most ? 1 : 0;
  }
  return found;
}

}  // namespace spikeloop::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace spikeloop {

bool changes_a_rate(const ScheduleChange& change) {
  return SPIKELOOP_KERNEL(changes_a_rate)(change);
}

void change_rates(const ScheduleChange& change) {
  SPIKELOOP_KERNEL(change_rates)(change);
}

bool all_within(std::span<const double> values, double limit) {
  return SPIKELOOP_KERNEL(all_within)(values, limit);
}

void negative_logarithms(std::span<double> values) {
  SPIKELOOP_KERNEL(negative_logarithms)(values);
}

void collect_due(const ScheduleBlock* blocks, std::span<const std::uint32_t> due, double limit,
                 ScheduleFiring& firing) {
  SPIKELOOP_KERNEL(collect_due)(blocks, due, limit, firing);
}

std::size_t keep_due(const ScheduleBlock* blocks, std::span<std::uint32_t> due, double limit,
                     float* earliest) {
  return SPIKELOOP_KERNEL(keep_due)(blocks, due, limit, earliest);
}

std::size_t find_due(const float* earliest, std::size_t count, double limit, std::uint32_t* due) {
  return SPIKELOOP_KERNEL(find_due)(earliest, count, limit, due);
}

}  // namespace spikeloop

#endif
