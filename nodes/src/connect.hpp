// `connect`: a linear map between continuous signals.
#pragma once

#include "spikeloop/core/node.hpp"

namespace spikeloop {

/// out[i] = sum over j of weights[i][j] * in[j], added in the order of LaneSum; for uniform
/// weights, the weight times the sum of all inputs.
NodeClass connect_class();

}  // namespace spikeloop
