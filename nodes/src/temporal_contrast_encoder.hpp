// `temporal_contrast_encoder`: a spike for every large difference between successive values (Petro,
// Kasabov & Kiss 2020, threshold-based representation).
#pragma once

#include "spikeloop/core/node.hpp"

namespace spikeloop {

/// When input d changes by more than `threshold` from one value to the next, the output's channel
/// 2d spikes, when it falls by more, channel 2d+1, both 1 us after the change. There is no memory
/// but the value before: small changes never add up (those of `step_forward_encoder` do). The first
/// value, and the first after the input was invalid, has none to be compared with.
NodeClass temporal_contrast_encoder_class();

}  // namespace spikeloop
