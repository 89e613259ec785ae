// `time_to_first_spike_encoder`: the larger the value, the earlier its spike (Thorpe, Delorme & Van
// Rullen 2001).
#pragma once

#include "spikeloop/core/node.hpp"

namespace spikeloop {

/// Time is divided into windows that begin at the multiples of `period`. The value x that a channel
/// holds at a window's begin s gives one spike at
///     s + t_min + (t_max - t_min) (1 - x) / 2:
/// t_min after it for x = 1, t_max for x = -1; none for x below `threshold`. A value that comes
/// within a window counts from the next one on. When the input becomes invalid there are no more
/// spikes, also in the window that has begun. Under out_of_range = pass, latencies are extrapolated
/// within 1 us and the period.
NodeClass time_to_first_spike_encoder_class();

}  // namespace spikeloop
