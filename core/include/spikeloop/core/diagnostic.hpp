// What a check has found, in an experiment, a .music file or a job.
#pragma once

#include <string>
#include <vector>

#include "spikeloop/core/error.hpp"

namespace spikeloop {

struct Diagnostic {
  Location where;
  std::string message;  ///< one line without the place: what is wrong; what to write
  int exit_code = 2;    ///< of the command that it ends; 0: a warning

  bool is_error() const { return exit_code != 0; }
  /// "loop.music:12:3: MESSAGE"
  std::string text() const;
};
using Diagnostics = std::vector<Diagnostic>;

Diagnostic error_at(const Location& where, std::string_view message);
/// An error when `strict`.
Diagnostic warning_at(const Location& where, std::string_view message, bool strict = false);
Diagnostic diagnostic_of(const Error& error);

void append(Diagnostics& list, const Diagnostics& others);
bool has_errors(const Diagnostics& list);
/// Its message ends with "(and 2 more: spikeloop check FILE)". There must be an error.
Diagnostic first_error(const Diagnostics& list, const std::string& file);

}  // namespace spikeloop
