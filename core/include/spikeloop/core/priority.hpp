// What has to be in time on a machine that is too busy.
#pragma once

namespace spikeloop {

/// Gives the calling thread, and threads that it starts, the lowest real-time priority: it gets the
/// processor before all others that have none (sched(7), SCHED_RR). For threads that stop robots
/// and compute next to nothing. Where the user may not ask for it (`ulimit -r` is 0, as by default
/// for others than root) nothing changes.
void run_before_others();

}  // namespace spikeloop
