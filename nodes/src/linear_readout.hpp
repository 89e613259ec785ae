// `linear_readout`: filtered and weighted spikes (Weidel et al. 2016, linear readout decoder).
#pragma once

#include "spikeloop/core/node.hpp"

namespace spikeloop {

/// out[i](t) = sum over spikes (s, j) with s <= t of weights[i][j] * exp(-(t - s) / tau) / tau,
/// evaluated at the interval's end; with weight 1, the firing rate in Hz. Late spikes count with
/// their true age. There is state per output, none per neuron.
NodeClass linear_readout_class();

}  // namespace spikeloop
