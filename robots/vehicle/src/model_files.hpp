// The files that an MJCF file is made of.
#pragma once

#include <string>

namespace spikeloop::vehicle {

/// Notes (FilesRead) all files that the attributes `file` of an MJCF file and of those that it
/// includes name: includes, meshes, textures, height fields. MuJoCo does not tell what it has read.
/// A shipped world has none to note: its files are those of the installation.
void note_model_files(const std::string& path);

}  // namespace spikeloop::vehicle
