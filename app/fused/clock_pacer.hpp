// sync: sim_time: the topic /clock decides when a tick begins.
#pragma once

#include <functional>
#include <memory>

#include "spikeloop/core/pacer.hpp"
#include "spikeloop/topics/session.hpp"
#include "waiting.hpp"

namespace spikeloop {

/// Simulated time 0 is the first time that /clock shows. A tick that /clock is more than a tick
/// ahead of is an overrun. Says when no clock comes, and when it stands still. wait_until() throws
/// a TransportError when the clock goes back.
/// @param alive called every 20 ms while it waits
std::unique_ptr<Pacer> make_clock_pacer(topics::Session& session, TimeNs tick, Waiting& waiting,
                                        std::function<void()> alive);

}  // namespace spikeloop
