// The key `plasticity` of a connection.
#pragma once

#include "spikeloop/config/network_file.hpp"
#include "yaml_section.hpp"

namespace spikeloop::yaml_text {

/// `projection` has its populations, delay and synapses.
/// @throws ConfigurationError: unknown rule or key, a value out of its bounds, a weight outside of
/// the rule's, a target that does not learn, a reward that is not there.
NetworkPlasticity read_plasticity(const NetworkFile& network, const NetworkProjection& projection,
                                  const std::string& what, const YAML::Node& node);

}  // namespace spikeloop::yaml_text
