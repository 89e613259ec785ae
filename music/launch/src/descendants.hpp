// The processes below a process, as /proc tells.
#pragma once

#include <sys/types.h>

#include <vector>

namespace spikeloop::launch {

/// Every living descendant of `ancestor`; those that have ended and wait to be reaped are left out.
std::vector<pid_t> descendants(pid_t ancestor);

}  // namespace spikeloop::launch
