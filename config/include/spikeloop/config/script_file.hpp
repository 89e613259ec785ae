// Scripts in Python that take part in jobs: read as text, never started to be looked at.
#pragma once

#include <string>

namespace spikeloop {

/// Whether a line of the file imports the package spikeloop, or a module of it. False for a file
/// that cannot be read.
bool imports_spikeloop(const std::string& path);

}  // namespace spikeloop
