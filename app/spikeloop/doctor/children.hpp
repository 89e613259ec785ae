// Programs started side by side, with one time limit for all.
#pragma once

#include <chrono>
#include <string>
#include <string_view>
#include <vector>

#include "spikeloop/launch/process_tree.hpp"

namespace spikeloop::app::doctor {

/// Everything has answered, or is given up, after this time.
inline constexpr std::chrono::milliseconds kPatience{10000};

struct Answer {
  int exit_code = 0;
  int signal = 0;       ///< that ended it; 0: none
  std::string out{};    ///< standard output
  std::string err{};    ///< standard error; or why the program could not be started
  bool in_time = true;  ///< false: it was killed
  double seconds = 0;

  /// Why it is of no use: started in vain, silent, crashed, failed. Empty: it ended well.
  std::string failure() const;
};

/// The first line of a text, and the last one that holds anything.
std::string_view first_line(std::string_view text);
std::string_view last_line(std::string_view text);

/// Runs them all at once; the answers have the order of the starts. Nothing is left running.
std::vector<Answer> ask(const std::vector<launch::ProgramStart>& starts,
                        std::chrono::milliseconds patience = kPatience);

}  // namespace spikeloop::app::doctor
