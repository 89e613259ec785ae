// sync: sim_time: the topic /clock decides when a tick begins.
#pragma once

#include <functional>
#include <memory>

#include "spikeloop/core/pacer.hpp"
#include "spikeloop/topics/session.hpp"
#include "waiting.hpp"

namespace spikeloop {

/// Simulated time 0 is the first time that /clock shows. A tick is an overrun if /clock is ahead of
/// it by more than a tick and by more than 1.5 periods of /clock. Warns if no clock comes, and if
/// it stands still. wait_until() throws a TransportError if no clock has come within the start
/// time-out, and if the clock goes back.
/// @param alive called every 20 ms while it waits
std::unique_ptr<Pacer> make_clock_pacer(topics::Session& session, TimeNs tick, Waiting& waiting,
                                        std::function<void()> alive);

}  // namespace spikeloop
