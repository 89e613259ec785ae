// Everything that can be known of a job before it starts.
#pragma once

#include <string>
#include <vector>

#include "spikeloop/config/music_file.hpp"
#include "spikeloop/launch/effective_file.hpp"

namespace spikeloop::launch {

struct Finding {
  std::string text;  ///< "loop.music:12:3: what is wrong; what to write"
  int exit_code = 2;
};

/// In the order of the file, the whole file first.
struct Findings {
  std::vector<Finding> errors;
  std::vector<std::string> warnings;

  void add_error(const Location& where, const std::string& message);
  /// An error when `strict`.
  void add_warning(const Location& where, const std::string& message, bool strict);
  void append(const Findings& others);
};

/// What concerns more than one program of an effective file: ticks, lengths, barriers, kinds and
/// widths of ports, cycles, processes, oddities of the text.
Findings check_together(const EffectiveFile& effective);

/// Whether every section's `binary` can be started by MUSIC's launcher from the section's `wd`,
/// seen from `directory`, and whether mpirun and music are there.
Findings check_programs(const MusicFile& file, const std::string& directory);

/// `spikeloop check`: the structure; then, when that holds, the effective file with the checks
/// above and what each of our programs says of its section, its keys and files.
/// @param here whether the programs will run on this machine, and must be there
/// @throws FileError when no scratch folder can be made.
Findings check_job(const MusicFile& file, const RunOptions& options, bool here = true);

/// "... (and 2 more: spikeloop check FILE)".
Finding first_error(const Findings& findings, const std::string& file);

}  // namespace spikeloop::launch
