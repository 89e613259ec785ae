// `argmax`: which channel is the largest.
#pragma once

#include "spikeloop/core/node.hpp"

namespace spikeloop {

/// out[0] = index of the largest input, counted from 0; of equal ones the first.
NodeClass argmax_class();

}  // namespace spikeloop
