// A .music file as an experiment file: the opposite of the separate layout.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "spikeloop/config/music_file.hpp"
#include "spikeloop/launch/effective_file.hpp"

namespace spikeloop::app {

struct ImportOptions {
  std::filesystem::path directory;  ///< where the experiment file will lie
  bool robot = false;               ///< with Spikeloop's own in place of ROS
};

struct Imported {
  std::string text;
  /// What an experiment file cannot say: the text has it as a comment.
  Diagnostics errors;
  Diagnostics notes;  ///< what is otherwise than in the job
};

/// Sections become nodes, connections lines, with the delays that they have in a job: a tick a
/// continuous connection, none for spikes. With the same recorded input the experiment then gives
/// the same spikes as the job.
/// @throws ConfigurationError for a file that MUSIC could not run.
Imported import_music(const MusicFile& file, const ImportOptions& options);

}  // namespace spikeloop::app
