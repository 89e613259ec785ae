// `threshold` and `sigmoid`: functions of each channel by itself.
#pragma once

#include "spikeloop/core/node.hpp"

namespace spikeloop {

/// out = scale * (in < threshold ? 0 : is_heaviside ? 1 : in) + shift
NodeClass threshold_class();

/// out = scale / (1 + exp(x_offset - slope * in)) + y_offset
NodeClass sigmoid_class();

}  // namespace spikeloop
