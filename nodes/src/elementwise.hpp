// `threshold`, `sigmoid`, `clip` and `normalise`: functions of each channel by itself.
#pragma once

#include "spikeloop/core/node.hpp"

namespace spikeloop {

/// out = scale * (in < threshold ? 0 : is_heaviside ? 1 : in) + shift
NodeClass threshold_class();

/// out = scale / (1 + exp(x_offset - slope * in)) + y_offset
NodeClass sigmoid_class();

/// out = min(max(in, min), max)
NodeClass clip_class();

/// out = out_min + (in - in_min) / (in_max - in_min) * (out_max - out_min); with `clip`, the input
/// is taken between in_min and in_max. out_min may be the larger one: that turns the range round.
NodeClass normalise_class();

}  // namespace spikeloop
