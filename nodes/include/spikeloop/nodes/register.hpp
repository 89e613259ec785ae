// The node classes that come with Spikeloop.
#pragma once

#include "spikeloop/core/registry.hpp"

namespace spikeloop {

/// Adds `connect`, `threshold`, `sigmoid`, `argmax`, `discretize`, `rate_encoder`,
/// `poisson_encoder` and `linear_readout`.
/// @throws ConfigurationError when a class of one of these names is already there.
void register_nodes(Registry& registry);

}  // namespace spikeloop
