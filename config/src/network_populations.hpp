// From one entry of `populations` to a population with its parameters.
#pragma once

#include <string>

#include "spikeloop/config/network_file.hpp"
#include "yaml_section.hpp"

namespace spikeloop::yaml_text {

/// More members than that belong elsewhere.
inline constexpr double kMostNeurons = 10'000'000;

/// @throws ConfigurationError: unknown model, a bad size, a parameter that the model does not have
/// or that is out of its bounds, a time that is not on the grid.
NetworkPopulation read_population(const NetworkFile& network, const Section& populations,
                                  const std::string& name);

/// `rate`, `values`, sine and noise: what poisson and the currents are driven by.
SourceParameters read_source(const Section& population, NeuronModel model, TimeNs resolution);

/// Refuses a time that is not on the grid; `what` names the key.
void check_on_grid(const std::string& what, TimeNs time, TimeNs resolution, const Location& where);

}  // namespace spikeloop::yaml_text
