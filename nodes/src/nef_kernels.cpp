#include "nef_kernels.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "vector_targets.hpp"
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "nef_kernels.cpp"
#include <hwy/cache_control.h>
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "kernel_lanes-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace spikeloop::HWY_NAMESPACE {

using Singles = hn::Rebind<float, Lanes>;

HWY_INLINE Vector load(const float* values) {
  return hn::PromoteTo(Lanes(), hn::LoadU(Singles(), values));
}

/// From `potential` to the threshold, when that is on the way to `target`.
HWY_INLINE Vector time_to_threshold(Vector potential, Vector target, Mask reaches,
                                    const NefModel& model) {
  const Lanes d;
  const Vector ratio = hn::Div(hn::Sub(target, potential), hn::Sub(target, set(model.threshold)));
  const Vector at_least_1 = hn::Max(hn::IfThenElse(reaches, ratio, set(1.0)), set(1.0));
  return hn::Mul(set(model.tau), logarithm(d, at_least_1));
}

/// When a spike stands whose neuron reaches the threshold at `crossing`: at the nearest nanosecond,
/// or the grid's next point, and always after 0.
HWY_INLINE Vector stamp_of(Vector crossing, const NefModel& model, double since_grid) {
  if (model.resolution == 0) {
    return nearest_stamp(crossing);
  }
  const Vector points =
      hn::Ceil(hn::Div(hn::Add(crossing, set(since_grid)), set(model.resolution)));
  return hn::Sub(hn::Mul(hn::Max(points, set(1.0)), set(model.resolution)), set(since_grid));
}

/// When neurons fire, from `lane` on.
HWY_INLINE Vector due_of(const NefFast& block, std::size_t lane, const NefModel& model,
                         double since_grid) {
  const Lanes d;
  const auto fires = hn::Gt(hn::Load(d, block.target + lane), set(model.threshold));
  const Vector crossing = hn::Abs(hn::Load(d, block.state + lane));
  return hn::IfThenElse(fires, stamp_of(crossing, model, since_grid), set(kNeverDue));
}

/// Potential and what is left of the refractory period, at the change.
struct Present {
  Vector potential;
  Vector rest;
  Mask committed;
};

HWY_INLINE Present present_of(const NefFast& fast, const NefSlow& slow, std::size_t lane,
                              const NefChange& change) {
  const Lanes d;
  const NefModel& model = *change.model;
  const Vector zero = hn::Zero(d);
  const Vector passed = set(change.passed);
  const Vector threshold = set(model.threshold);
  const Vector state = hn::Load(d, fast.state + lane);
  const Vector crossing = hn::Abs(state);
  const Vector target = hn::Load(d, fast.target + lane);
  const Vector rest = load(slow.rest + lane);
  const Mask rises = hn::Gt(target, threshold);
  const Mask has_fired = hn::And(rises, hn::Lt(state, zero));
  // A neuron that has fired begins to rise at its crossing minus the time that rising takes.
  const Vector rising_time = time_to_threshold(zero, target, rises, model);
  const Vector begin = hn::IfThenElse(has_fired, hn::Sub(crossing, rising_time), rest);
  Vector left = hn::Max(hn::Sub(begin, passed), zero);
  // V(t) = target + (V(s) - target) exp((s - t) / tau), from the crossing or from `rest`.
  const Vector known_at = hn::IfThenElse(rises, crossing, begin);
  const Vector known = hn::IfThenElse(rises, threshold, state);
  const Vector factor = exponential(d, hn::Div(hn::Sub(known_at, passed), set(model.tau)));
  // Rounding must not carry it over the threshold: it would fire when its input ends.
  Vector potential = hn::Min(fused(d, hn::Sub(known, target), factor, target), threshold);
  // Between two changes it goes one way only: what stays at the floor is found at the change.
  potential = hn::Max(potential, set(model.floor));
  potential = hn::IfThenElse(hn::Gt(left, zero), zero, potential);
  Mask committed = hn::FirstN(d, 0);
  if (model.resolution > 0) {
    committed = hn::And(rises, hn::Le(crossing, passed));
    const double after =
        model.resolution - change.since_grid + std::max(model.refractory, kNefShortestInterval);
    left = hn::IfThenElse(committed, set(after), left);
    potential = hn::IfThenElse(committed, zero, potential);
  }
  return {potential, left, committed};
}

/// What the potentials tend to with the new input.
HWY_INLINE Vector new_target(const NefSlow& block, std::size_t lane, const float* directions,
                             const NefChange& change) {
  const Lanes d;
  Vector along = hn::Zero(d);
  for (std::size_t k = 0; k < change.dimensions; ++k) {
    along = fused(d, load(directions + k * kBlock + lane), set(change.input[k]), along);
  }
  const Vector current = fused(d, load(block.gain + lane), along, load(block.bias + lane));
  return fused(d, set(change.model->scale), current, set(change.model->threshold));
}

void note_committed(Mask committed, std::size_t first, std::vector<std::uint32_t>& neurons) {
  const Lanes d;
  alignas(64) double flags[kBlock];
  hn::Store(hn::IfThenElseZero(committed, set(1.0)), d, flags);
  for (std::size_t i = 0; i < hn::Lanes(d); ++i) {
    if (flags[i] != 0) {
      neurons.push_back(static_cast<std::uint32_t>(first + i));
    }
  }
}

void change_targets(const NefChange& change) {
  const Lanes d;
  const NefModel& model = *change.model;
  const std::size_t stride = change.dimensions * kBlock;
  for (std::size_t b = 0; b < change.block_count; ++b) {
    NefFast& fast = change.fast[b];
    NefSlow& slow = change.slow[b];
    Vector least = set(kNeverDue);
    for (std::size_t lane = 0; lane < kBlock; lane += hn::Lanes(d)) {
      const Present now = present_of(fast, slow, lane, change);
      if (!hn::AllFalse(d, now.committed)) {
        note_committed(now.committed, b * kBlock + lane, *change.committed);
      }
      const Vector target = change.directions == nullptr
                                ? now.potential
                                : new_target(slow, lane, change.directions + b * stride, change);
      const Mask rises = hn::Gt(target, set(model.threshold));
      const Vector crossing =
          hn::Add(now.rest, time_to_threshold(now.potential, target, rises, model));
      hn::Store(hn::IfThenElse(rises, crossing, now.potential), d, fast.state + lane);
      hn::Store(target, d, fast.target + lane);
      hn::StoreU(hn::DemoteTo(Singles(), now.rest), Singles(), slow.rest + lane);
      const Vector stamp = stamp_of(crossing, model, change.since_grid);
      least = hn::Min(least, hn::IfThenElse(rises, stamp, set(kNeverDue)));
    }
    change.earliest[b] = not_later_than(hn::GetLane(hn::MinOfLanes(d, least)));
  }
}

/// Notes the spikes of a block, and their neurons' targets.
HWY_INLINE void collect(NefFiring& firing, std::uint32_t index, double* targets) {
  const Lanes d;
  const NefFast& block = firing.fast[index];
  alignas(64) double stamps[kBlock];
  unsigned due = 0;
  for (std::size_t lane = 0; lane < kBlock; lane += hn::Lanes(d)) {
    const Vector stamp = due_of(block, lane, *firing.model, firing.since_grid);
    hn::Store(stamp, d, stamps + lane);
    due |= bits_at_most(stamp, firing.limit) << lane;
  }
  for (; due != 0; due &= due - 1) {
    const auto lane = static_cast<std::uint32_t>(std::countr_zero(due));
    firing.neurons[firing.count] = index * static_cast<std::uint32_t>(kBlock) + lane;
    firing.stamps[firing.count] = stamps[lane];
    targets[firing.count] = block.target[lane];
    ++firing.count;
  }
}

/// The intervals from a spike to the next crossing, for so many targets; a vector more is written.
void solve_intervals(const NefModel& model, std::size_t count, double* targets) {
  const Lanes d;
  const Mask all = hn::FirstN(d, hn::Lanes(d));
  for (std::size_t i = 0; i < count; i += hn::Lanes(d)) {
    const Vector target = hn::Load(d, targets + i);
    const Vector rising = time_to_threshold(hn::Zero(d), target, all, model);
    const Vector interval = hn::Add(rising, set(model.refractory));
    hn::Store(hn::Max(interval, set(kNefShortestInterval)), d, targets + i);
  }
}

/// Lets the noted spikes' neurons begin anew.
void restart(NefFiring& firing, const double* intervals) {
  const bool on_grid = firing.model->resolution > 0;
  for (std::size_t i = 0; i < firing.count; ++i) {
    double& state = firing.fast[firing.neurons[i] / kBlock].state[firing.neurons[i] % kBlock];
    // On a grid the neuron is reset there; else rounding to nanoseconds must not add up.
    const double reset = on_grid ? firing.stamps[i] : std::fabs(state);
    state = -(reset + intervals[i]);
  }
}

double earliest_of(const NefFast& block, const NefModel& model, double since_grid) {
  const Lanes d;
  Vector least = set(kNeverDue);
  for (std::size_t lane = 0; lane < kBlock; lane += hn::Lanes(d)) {
    least = hn::Min(least, due_of(block, lane, model, since_grid));
  }
  return hn::GetLane(hn::MinOfLanes(d, least));
}

std::size_t fire_once(NefFiring& firing, std::span<std::uint32_t> blocks) {
  alignas(64) double intervals[(kMostBlocks + 1) * kBlock];
  firing.count = 0;
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    const NefFast& later = firing.fast[blocks[std::min(i + kAhead, blocks.size() - 1)]];
    hwy::Prefetch(later.state);
    hwy::Prefetch(later.target);
    collect(firing, blocks[i], intervals);
  }
  solve_intervals(*firing.model, firing.count, intervals);
  restart(firing, intervals);
  std::size_t kept = 0;
  for (const std::uint32_t index : blocks) {
    const double earliest = earliest_of(firing.fast[index], *firing.model, firing.since_grid);
    firing.earliest[index] = not_later_than(earliest);
    blocks[kept] = index;
    kept += earliest <= firing.limit ? 1 : 0;
  }
  return kept;
}

}  // namespace spikeloop::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace spikeloop {

void change_targets(const NefChange& change) {
  SPIKELOOP_KERNEL(change_targets)(change);
}

std::size_t fire_once(NefFiring& firing, std::span<std::uint32_t> blocks) {
  return SPIKELOOP_KERNEL(fire_once)(firing, blocks);
}

}  // namespace spikeloop

#endif
