#pragma once

namespace spikeloop {

/// In a forked process: no signal is blocked, and each has its default effect.
void reset_signals();

}  // namespace spikeloop
