// The files that an MJCF file is made of.
#pragma once

#include <string>
#include <vector>

#include "model_text.hpp"

namespace spikeloop::vehicle {

/// Reads an MJCF file and all files that it includes, and notes (FilesRead) these and the other
/// files that their attributes `file` name: meshes, textures, height fields. MuJoCo does not report
/// what it has read. Empty for a shipped world, whose files are part of the installation.
std::vector<ModelText> read_model_files(const std::string& path);

}  // namespace spikeloop::vehicle
