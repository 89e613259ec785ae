// Everything that can be known of a job before it starts.
#pragma once

#include <string>

#include "spikeloop/config/music_file.hpp"
#include "spikeloop/core/diagnostic.hpp"
#include "spikeloop/launch/effective_file.hpp"

namespace spikeloop::launch {

/// What concerns more than one program of an effective file: ticks, lengths, barriers, kinds and
/// widths of ports, cycles, processes, warnings of the text.
Diagnostics check_together(const EffectiveFile& effective);

/// Whether every section's `binary` can be started by MUSIC's launcher from the section's `wd`,
/// seen from `directory`, and whether mpirun and music are there.
Diagnostics check_programs(const MusicFile& file, const std::string& directory);

/// `spikeloop check`: the structure; then, when that holds, the effective file with the checks
/// above and what each of our programs says of its section, its keys and files.
/// @param here whether the programs will run on this machine, and must be there
/// @throws FileError when no scratch folder can be made.
Diagnostics check_job(const MusicFile& file, const RunOptions& options, bool here = true);

}  // namespace spikeloop::launch
