// `discretize`: a position as the activity of place cells.
#pragma once

#include "spikeloop/core/node.hpp"

namespace spikeloop {

/// out[i] = 2 exp(-sum over j of ((in[j] - mu[i][j]) / sigma[i][j])^2 / 2) - 1: 1 at a cell's
/// centre, -1 far away. A row of `grid` is one cell: mu of every input channel, then sigma.
NodeClass discretize_class();

}  // namespace spikeloop
