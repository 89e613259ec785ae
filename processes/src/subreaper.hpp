// The process between us and a program: starts it, reports on it, ends its tree.
#pragma once

#include <sys/types.h>

#include "spikeloop/processes/process_tree.hpp"

namespace spikeloop {

/// What a subreaper tells; `value` is a process id, an errno, a wait status.
struct SubreaperNews {
  enum class Kind : int { started, cannot_start, ended };
  Kind kind;
  int value;
};

inline constexpr char kEndTree = 't';
inline constexpr char kKillTree = 'k';

/// Descriptors that the subreaper goes on with; everything else is closed.
struct SubreaperFiles {
  int owner;  ///< its end of the socket pair
  int out;    ///< the program's standard output
  int err;
};

/// Runs in the forked process and never returns.
[[noreturn]] void keep(const ProgramStart& start, const SubreaperFiles& files);

}  // namespace spikeloop
