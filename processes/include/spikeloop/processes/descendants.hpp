// The processes below a process, as /proc tells.
#pragma once

#include <sys/types.h>

#include <map>
#include <optional>
#include <string>
#include <vector>

namespace spikeloop {

/// Every living descendant of `ancestor`; those that have ended and wait to be reaped are left out.
std::vector<pid_t> descendants(pid_t ancestor);

/// By SIGSTOP, or by a debugger.
bool is_stopped(pid_t process);

/// Waits for something that is no disk: a pipe, a lock.
bool is_sleeping(pid_t process);

/// The sections whose programs live below `ancestor`, as MUSIC's launcher has told them; true: one
/// of its processes has been stopped (SIGSTOP).
std::map<std::string, bool> living_sections(pid_t ancestor);

/// How a process has ended, as waitpid() tells it, when its parent has not asked yet; -1: it is
/// gone, or may not be looked at; nothing: it lives.
std::optional<int> end_of(pid_t process);

}  // namespace spikeloop
