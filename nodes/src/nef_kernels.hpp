// The inner loops of a NEF population, for every instruction set with the same results to the bit.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "due_blocks.hpp"

namespace spikeloop {

/// What all neurons of a population share. Potentials are relative to the resting and reset
/// potential; times are in ns.
struct NefModel {
  double tau;         ///< time constant of the membrane
  double scale;       ///< a potential tends to  threshold + scale * (bias + gain * along)
  double threshold;   ///< > 0
  double floor;       ///< a potential is never below it: 0, or minus infinity
  double refractory;  ///< period after a spike in which the potential stays 0
  double resolution;  ///< of the grid on which spikes stand; 0: none
};

/// What a spike needs of a block's neurons. Times count from the latest change of the input, ns.
struct alignas(64) NefFast {
  /// Of a neuron whose `target` is above the threshold: when its potential reaches the threshold,
  /// negative once it has fired since the change. Of another one: the potential at `rest`.
  double state[kBlock];
  double target[kBlock];  ///< what the potential tends to
};

/// What only a change of the input needs besides.
struct NefSlow {
  float rest[kBlock];  ///< what was left of a refractory period at the change
  float gain[kBlock];
  float bias[kBlock];  ///< from the threshold on, so that it is precise there
};

// A block has one more number, before which it has no spike.
static_assert(sizeof(NefFast) + sizeof(NefSlow) + sizeof(float) <= 32 * kBlock);

/// A change of the input: every neuron's present potential, and when it fires with the new target.
struct NefChange {
  const NefModel* model;
  NefFast* fast;
  NefSlow* slow;
  float* earliest;  ///< of each block: a time not later than its first spike
  std::size_t block_count;
  /// Each block: its neurons' first components, then the second ones, ...; null: neither input nor
  /// leak, the potentials stay.
  const float* directions;
  const double* input;
  std::size_t dimensions;
  double passed;      ///< since the change before
  double since_grid;  ///< from the grid's point before the new change to it
  /// Neurons that have reached the threshold and whose spike is due at the grid's next point.
  std::vector<std::uint32_t>* committed;
};
void change_targets(const NefChange& change);

/// The spikes of some blocks up to `limit`, at most one a neuron.
struct NefFiring {
  const NefModel* model;
  NefFast* fast;
  float* earliest;
  double since_grid = 0;
  double limit = 0;
  std::size_t count = 0;  ///< of spikes
  std::uint32_t neurons[kMostBlocks * kBlock] = {};
  double stamps[kMostBlocks * kBlock] = {};
};
/// Fires neurons of `blocks`. Returns how many blocks have more spikes, which are put first.
std::size_t fire_once(NefFiring& firing, std::span<std::uint32_t> blocks);

/// Between two changes of the input, neurons fire at most once in a microsecond.
inline constexpr double kNefShortestInterval = 1000;

}  // namespace spikeloop
