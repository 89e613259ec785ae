// Where a job keeps its files.
#pragma once

#include <string>

#include "spikeloop/status/status.hpp"

namespace spikeloop::launch {

/// Absolute.
std::string directory_of(const std::string& file);

/// Makes a directory and those above it; returns its absolute path. @throws FileError
std::string make_folder(const std::string& path);

/// Holds a run folder while the result lives: one folder takes one run at a time.
/// @throws FileError when another run holds it, or a pipe or device is in it; `as_written` is the
/// folder's name in the message.
Descriptor lock_folder(const std::string& path, const std::string& as_written);

/// @throws ConfigurationError when `path`, which we are about to write, is the user's `file`.
void refuse_to_overwrite(const std::string& file, const std::string& path);

}  // namespace spikeloop::launch
