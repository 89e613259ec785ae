// From one entry of `connections` to synapses grouped by source.
#pragma once

#include <vector>

#include "spikeloop/config/network_file.hpp"
#include "yaml_section.hpp"

namespace spikeloop::yaml_text {

/// Index of the population called `name`.
/// @throws ConfigurationError with "did you mean".
std::size_t find_population(const NetworkFile& network, const std::string& name,
                            const Location& where, const std::string& what);

/// What `weight` is written in: "mV", "pA" or "1".
std::string unit_of_weight(NeuronModel target);

/// A delay is at least a resolution, and a multiple of it. `what` begins the message.
void check_delay(const std::string& what, TimeNs delay, TimeNs resolution, const Location& where);

/// The steps of a delay, for each of `wide` sources or targets, fit into memory.
void check_buffer(const std::string& what, TimeNs delay, TimeNs resolution, std::uint32_t wide,
                  const char* members, const Location& where);

/// A member of a population, in a list called `what`.
std::uint32_t read_index(const std::string& file, const std::string& what, const YAML::Node& node,
                         const NetworkPopulation& population);

/// @throws ConfigurationError: unknown population or rule, sizes that do not fit, a bad weight,
/// delay or pair.
NetworkProjection read_connection(const NetworkFile& network, std::size_t index,
                                  const YAML::Node& node, const NetworkWeightLoader& load_weights);

}  // namespace spikeloop::yaml_text
