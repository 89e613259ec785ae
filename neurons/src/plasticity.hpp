// Synapses that learn from the times of spikes: STDP with all pairs or the nearest ones, and STDP
// modulated by reward. Weights change at spikes alone, in closed form.
//
// The conventions are those of NEST's stdp_synapse, stdp_nn_symm_synapse and
// stdp_dopamine_synapse (Morrison, Diesmann & Gerstner 2008, Biol. Cybern. 98:459-478, section 4;
// Potjans, Morrison & Diesmann 2010, Front. Comput. Neurosci. 4:141): the delay is the dendrite's,
// so that a spike of the target at s reaches the synapse at s + delay, while one of the source is
// there at once. What reaches a synapse at the same time does not pair: the potentiation comes
// first, with the source's earlier spikes, and the depression sees the target's earlier ones.
//
// A synapse is brought up to date when its source fires, as in NEST. `settle` does so for all of
// them, in the same order of the same operations.
#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "spikeloop/config/network_file.hpp"

namespace spikeloop::neurons {

/// The learning synapses of one projection. Times are whole numbers of the simulation's grid.
class Plasticity {
 public:
  Plasticity() = default;
  Plasticity(const Plasticity&) = delete;
  Plasticity& operator=(const Plasticity&) = delete;
  virtual ~Plasticity() = default;

  /// A spike of a source leaves at `time`, behind every spike of the targets up to time - delay;
  /// returns the weights that it carries, in the order of the projection. A time before the
  /// source's last one, of a spike that came late, counts as that one.
  virtual std::span<const double> source_fired(std::uint32_t source, std::int64_t time) = 0;
  virtual void target_fired(std::uint32_t target, std::int64_t time) = 0;
  /// A spike of the rewarding population reaches the synapses at `time`, or now, if that has
  /// passed.
  virtual void reward_fired(std::int64_t) {}
  /// The rewarding signal from `time` on.
  virtual void reward_signal(double, std::int64_t) {}
  /// Everything up to `time` is known: brings all synapses there, and forgets what no spike needs
  /// any more.
  virtual void settle(std::int64_t time) = 0;
  /// Weights in the order of the projection, as the last call left them.
  virtual std::span<const double> weights() const = 0;
};

/// `resolution` is the length of the grid's step.
std::unique_ptr<Plasticity> make_plasticity(const NetworkProjection& projection, TimeNs resolution);

}  // namespace spikeloop::neurons
