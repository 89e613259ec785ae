// `rate_encoder`: regular spikes at a rate that follows the input (Weidel et al. 2016, eq. 1).
#pragma once

#include "spikeloop/core/node.hpp"

namespace spikeloop {

/// Each channel integrates its rate and spikes whenever the integral passes a whole number: the
/// number of spikes equals the integral of the rate, to within one, whatever the input does.
NodeClass rate_encoder_class();

}  // namespace spikeloop
