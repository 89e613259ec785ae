// The channel on which each process tells how it is: docs/live-view.md.
#pragma once

#include "spikeloop/live/feed.hpp"

namespace spikeloop::live {

Channel status_channel();

}  // namespace spikeloop::live
