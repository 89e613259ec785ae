// The names that spikeloop-node goes by, and what each of them runs.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "spikeloop/core/registry.hpp"
#include "spikeloop/process/music_main.hpp"

namespace spikeloop {

struct NodeProgram {
  const char* name;
  const char* node_class;
  const char* table;          ///< the parameter that is read from a file; null: none
  const char* older_key;      ///< its spelling in the older program; null: none
  const char* default_table;  ///< what the older program takes when it is not given
  bool accept_one_tick;       ///< the older program's acceptable latency
  const char* example;        ///< keys in the section
};

/// The program of this name; null for spikeloop-node itself and any other name.
const NodeProgram* find_node_program(std::string_view name);

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
