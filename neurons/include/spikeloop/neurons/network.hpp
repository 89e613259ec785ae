// The built-in network: repeaters, integrate-and-fire and rate neurons from a network file.
//
// iaf_psc_delta and iaf_psc_exp are integrated exactly on the grid (Rotter & Diesmann 1999,
// Biol. Cybern. 81:381-402, eq. 3) with NEST's conventions: spikes that come in are rounded up to
// the grid, act a delay later at the end of a step, and leave stamped with the end of the step in
// which the membrane potential reached the threshold. Large models belong in NEST, NEURON or
// Brian2.
#pragma once

#include <memory>

#include "spikeloop/config/network_file.hpp"
#include "spikeloop/core/node.hpp"
#include "spikeloop/core/registry.hpp"

namespace spikeloop {

/// The node class `network`: ports `in` and `out` (spikes), `signal`, `potential` and `rates`
/// (continuous), parameter `network` (path of the network file). Its factory reads the file.
NodeClass network_class();

/// The same for a network that was read before: its ports have the file's widths, those that
/// nothing uses are not there, and what is recorded has ports of its own, NAME_spikes and NAME_V_m.
NodeClass network_class(const NetworkFile& network);

/// Makes the node of a network that was read before; `name` and `seed` key its random numbers.
/// Counters: spikes (that left by port `out`), late_spikes (that came in at or before the begin of
/// their interval). Results: the weights that `save` names.
std::unique_ptr<Node> make_network(NetworkFile network, const std::string& name = "network",
                                   std::uint64_t seed = 1);

/// Adds the node classes of this module.
void register_neurons(Registry& registry);

}  // namespace spikeloop
