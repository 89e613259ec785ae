// The command line of spikeloop-guard.
#pragma once

#include <optional>
#include <string>

namespace spikeloop::guard {

struct Options {
  std::string socket;
  int owner = -1;  ///< a descriptor: the socket to the launcher that started us
};

/// Nothing when the program has to end with `exit_code`; what there is to say has been printed.
std::optional<Options> parse_options(int argc, char** argv, int& exit_code);

}  // namespace spikeloop::guard
