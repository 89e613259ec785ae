// `delay`: a signal, some time later.
#pragma once

#include "spikeloop/core/node.hpp"

namespace spikeloop {

/// During (t, t+dt] the output is what the input was from t - delay on: the newest value at or
/// before it, valid or not; invalid until there is one. So a change at s shows in the first
/// interval that begins at s + delay or later. Memory grows with the revisions within one delay.
NodeClass delay_class();

}  // namespace spikeloop
