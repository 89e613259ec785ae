// `poisson_encoder`: Poisson spikes at a rate that follows the input (Weidel et al. 2016, eq. 2).
#pragma once

#include "spikeloop/core/node.hpp"

namespace spikeloop {

/// Each channel is an inhomogeneous Poisson process, exact for a changing rate: the integral of the
/// rate between two spikes is exponentially distributed with mean 1. Draw d of a channel's random
/// stream decides its spike d, so channels are independent and no spike depends on ticks.
NodeClass poisson_encoder_class();

}  // namespace spikeloop
