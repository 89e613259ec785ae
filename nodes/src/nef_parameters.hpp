// What a NEF encoder's neurons are like: declared as data, checked, and drawn from the seed.
#pragma once

#include <cstdint>
#include <vector>

#include "nef_population.hpp"
#include "spikeloop/core/node.hpp"

namespace spikeloop {

std::vector<ParameterDescription> nef_parameters();

/// @throws ConfigurationError: a key that the preset has no use for, a range that ends before it
/// begins, rates that the refractory period forbids, a refractory period off the grid.
NefModel nef_model(const Parameters& given);

/// Draws the neurons first, first + 1, ... for inputs of so many dimensions.
/// Nengo's convention: a neuron fires at `max_rate` where its direction meets the radius, and
/// begins to fire at `intercept` (Bekolay et al. 2014; nengo.neurons.LIF.gain_bias). The older
/// programs': gain and bias are currents within bounds (`preset` rma and ma).
void draw_nef_neurons(const NodeSetup& setup, std::uint32_t first, std::uint32_t count,
                      std::uint32_t dimensions, NefPopulation& population);

}  // namespace spikeloop
