// The loop of spikeloop-robot: wait, publish, take the command, step.
#pragma once

#include <atomic>

#include "options.hpp"
#include "spikeloop/status/status.hpp"
#include "spikeloop/topics/session.hpp"

namespace spikeloop::robot {

/// Runs until the duration has passed or `stop` becomes true, writes the files and reports.
/// @throws Error of every kind.
void run(const RunOptions& options, const topics::RosArguments& arguments,
         const status::Sender& status, const std::atomic<bool>& stop);

/// The same with an experiment in place of the clock (docs/stepping.md): run by run, until `stop`.
void run_stepped(const RunOptions& options, const topics::RosArguments& arguments,
                 const status::Sender& status, const std::atomic<bool>& stop);

}  // namespace spikeloop::robot
