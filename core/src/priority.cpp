#include "spikeloop/core/priority.hpp"

#include <sched.h>

namespace spikeloop {

void run_before_others() {
  const sched_param lowest{.sched_priority = sched_get_priority_min(SCHED_RR)};
  sched_setscheduler(0, SCHED_RR, &lowest);
}

}  // namespace spikeloop
