// `low_pass`: a first-order lag of each channel.
#pragma once

#include "spikeloop/core/node.hpp"

namespace spikeloop {

/// tau dy/dt = x - y, solved exactly for the piecewise constant input:
///     y(t) = x + (y(t0) - x) exp(-(t - t0) / tau)
/// from the latest change of x, at t0. `out` is y at the interval's end; it has a new revision only
/// while it changes. A channel begins, with its first value or with the first after the input was
/// invalid, at `initial`, or there and then.
NodeClass low_pass_class();

}  // namespace spikeloop
