// The node classes that come with Spikeloop.
#pragma once

#include "spikeloop/core/registry.hpp"

namespace spikeloop {

/// Adds the adapters `connect`, `threshold`, `sigmoid`, `clip`, `normalise`, `argmax`,
/// `discretize`, `low_pass`, `delay`, `function`; the encoders `rate_encoder`, `poisson_encoder`,
/// `nef_encoder`, `population_encoder`, `step_forward_encoder`, `temporal_contrast_encoder`,
/// `time_to_first_spike_encoder`; the decoders `linear_readout`, `population_vector`,
/// `winner_take_all`, `rate_window`.
/// @throws ConfigurationError when a class of one of these names is already there.
void register_nodes(Registry& registry);

}  // namespace spikeloop
