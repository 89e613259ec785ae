// Programs that may hang or crash, run side by side with one time limit for all.
#pragma once

#include <chrono>
#include <string>
#include <string_view>
#include <vector>

#include "spikeloop/processes/scratch_folder.hpp"

namespace spikeloop::app::doctor {

/// What has not answered by then is killed.
inline constexpr std::chrono::seconds kPatience{10};

/// A program, as a path or searched in PATH, and its arguments. Empty: nothing is started.
using Command = std::vector<std::string>;

struct Answer {
  std::string out{};      ///< standard output; beyond 1 MB it is cut
  std::string failure{};  ///< not started, no answer in time, crashed, failed; empty: exit code 0
  bool in_time = true;
  double seconds = 0;
};

/// The last line of a text that is not blank.
std::string_view last_line(std::string_view text);

/// Runs all commands at once, in the environment that a job's programs have but without our Python
/// package; the answers have their order. Nothing is left running.
/// @param scratch for the files of Open MPI's jobs, if there are such among the commands
std::vector<Answer> ask(const std::vector<Command>& commands,
                        const ScratchFolder* scratch = nullptr);

}  // namespace spikeloop::app::doctor
