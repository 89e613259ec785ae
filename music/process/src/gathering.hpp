// Puts together what the processes of a section have computed each for its share of the channels.
#pragma once

#include "process_impl.hpp"

namespace spikeloop::music {

/// A node with ports `in` and `out` of this kind. Spikes come out in the first process alone,
/// because MUSIC mixes up the ticks of several senders; signals in all.
NodeClass gathering_class(PortKind kind, const Ranks& ranks);

}  // namespace spikeloop::music
