// main() of every MUSIC program of Spikeloop.
#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "spikeloop/core/parameters.hpp"
#include "spikeloop/process/process.hpp"

namespace spikeloop::music {

/// What --help and --version print.
struct ProgramText {
  std::string name;                              ///< "rate_encoder"
  std::string summary;                           ///< one line
  std::string ports;                             ///< a line a port
  std::vector<ParameterDescription> parameters;  ///< its own keys
  std::string example;                           ///< sections of a .music file
  std::string notes;                             ///< more paragraphs, or nothing
  CommonDefaults defaults;
  bool may_run_alone = false;  ///< `--alone FILE LABEL` runs a section without MUSIC
  /// More options of the program standing alone, e.g. "--list": what it prints.
  struct Option {
    std::string text;  ///< one line for --help
    std::function<std::string()> print;
  };
  std::map<std::string, Option> options;
};

/// The basename of argv[0]: which of its names a program was called by, standing alone.
std::string called_as(int argc, char** argv);

/// True when MUSIC has started this process: by `music FILE` or by --music-config.
bool started_by_music(int argc, char** argv);

/// The section's label before Setup: from _MUSIC_CONFIG_ or `--app-label`; else the basename of
/// argv[0].
std::string section_label(int argc, char** argv);

/// The section of a simulator that will do MUSIC's Setup itself; mends for it what a Process mends
/// for its own Setup.
SimulatorsMusic before_simulators_setup(int argc, char** argv);

/// The text of --help.
std::string help_text(const ProgramText& text);

/// What the log says goes to standard error, a line each: "LABEL: message".
void log_to_standard_error(const std::string& label);

/// Prints "LABEL: message", tells the launcher, and ends the whole job with MPI_Abort: a program
/// that merely returned would leave the others hanging. Returns `exit_code` when MPI is not up.
int end_job(const std::string& label, int exit_code, const std::string& message);

/// Without MUSIC: runs `body` for `--alone FILE LABEL`, if the program may run alone; else answers
/// --help, --version, the program's own options, and `--check-section FILE LABEL`, which runs
/// `body` on a Process that only checks: warnings and one error on standard error, a line each,
/// "warning: " or "error: " before it. Anything else is an error and gives 2. Under MUSIC: runs
/// `body`; what it throws is printed in one line "LABEL: message", reported to the launcher, and
/// ends the whole job with the error's exit code (MPI_Abort: any other way out would leave the
/// other programs hanging).
int music_main(int argc, char** argv, const ProgramText& text,
               const std::function<int(Process&)>& body);

}  // namespace spikeloop::music
