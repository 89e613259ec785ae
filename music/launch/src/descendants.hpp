// The processes below a process, as /proc tells.
#pragma once

#include <sys/types.h>

#include <map>
#include <string>
#include <vector>

namespace spikeloop::launch {

/// Every living descendant of `ancestor`; those that have ended and wait to be reaped are left out.
std::vector<pid_t> descendants(pid_t ancestor);

/// The sections whose programs live below `ancestor`, as MUSIC's launcher has told them; true: one
/// of its processes has been stopped (SIGSTOP).
std::map<std::string, bool> living_sections(pid_t ancestor);

}  // namespace spikeloop::launch
