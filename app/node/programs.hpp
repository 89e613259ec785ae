// The names that spikeloop-node goes by, and what each of them runs.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "spikeloop/config/older_programs.hpp"
#include "spikeloop/core/registry.hpp"
#include "spikeloop/process/music_main.hpp"

namespace spikeloop {

/// The built-in node classes and those of SPIKELOOP_PLUGIN_PATH.
void fill_registry(Registry& registry);

/// --help of the program of this name.
music::ProgramText node_program_text(const std::string& name);

/// The node class that this process is to run: by its name, or by the keys `node` and `plugin`.
/// @throws ConfigurationError for an unknown class or a plug-in that cannot be loaded.
const NodeClass& node_class_of(const music::Process& process, Registry& registry);

/// Its parameters from the section's keys.
/// @throws ConfigurationError as resolve(), and when the table is written in both spellings.
Parameters node_parameters(music::Process& process, const NodeClass& node_class);

}  // namespace spikeloop
