// `rate_window`: spikes counted in a sliding window (Dayan & Abbott 2001, sec. 1.2).
#pragma once

#include "spikeloop/core/node.hpp"

namespace spikeloop {

/// out[i](t) = number of spikes of channel i in (t - window, t] / window, in Hz, evaluated at the
/// interval's end. The counts are exact. A late spike counts as long as its true time is in the
/// window. Memory grows with the spikes of a window, never with the run.
NodeClass rate_window_class();

}  // namespace spikeloop
