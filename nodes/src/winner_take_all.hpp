// `winner_take_all`: which neuron fires most.
#pragma once

#include "spikeloop/core/node.hpp"

namespace spikeloop {

/// The rates are filtered with an exponential kernel. A channel wins when its rate exceeds the
/// winner's by the fraction `margin`; of several that do so at one moment the one with the highest
/// rate, of equal ones the lowest channel. All rates decay alike, so that the winner changes at
/// spikes alone, whatever the tick. There is none, and `out` is invalid, before the first spike; a
/// late spike can change the winner from its arrival on.
/// output = one_hot: 1 for the winner, else 0; index: its number, counted from 0, in one channel;
/// rate: its rate in Hz at the interval's end in its channel, else 0.
NodeClass winner_take_all_class();

}  // namespace spikeloop
