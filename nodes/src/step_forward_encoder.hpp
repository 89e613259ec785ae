// `step_forward_encoder`: a spike for every step that the input has gone up or down (Kasabov et al.
// 2016; Petro, Kasabov & Kiss 2020, step-forward encoding; delta modulation).
#pragma once

#include "spikeloop/core/node.hpp"

namespace spikeloop {

/// Channel d has a base. While the input is a `threshold` or more above it, the output's channel 2d
/// spikes and the base goes up by one threshold; while it is as far below, channel 2d+1 spikes and
/// the base goes down. The first spike comes 1 us after the change that makes it due, and the
/// spikes of one input follow each other at distances of at least `min_interval`; if the input
/// changes meanwhile, the comparison goes on with the new value. So the base is never a threshold
/// away from an input that has rested for long enough, and adding up the spikes gives the base.
NodeClass step_forward_encoder_class();

}  // namespace spikeloop
