// The programs that go by older names: what each of them runs, and what it did differently from the
// node classes.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "spikeloop/config/dialect.hpp"
#include "spikeloop/config/music_file.hpp"
#include "spikeloop/core/parameters.hpp"

namespace spikeloop {

/// A node under a name of its own.
struct NodeProgram {
  const char* name;
  const char* node_class;
  const char* table;          ///< the parameter that is read from a file; null: none
  const char* older_key;      ///< its spelling in the older program; null: none
  const char* default_table;  ///< what the older program takes when it is not given
  bool accept_one_tick;       ///< the older program's acceptable latency
  const char* example;        ///< keys in the section
};

std::span<const NodeProgram> node_programs();
/// The program of this name; null for spikeloop-node itself and any other name.
const NodeProgram* find_node_program(std::string_view name);

/// A topic's program, and what the older program of this name took for keys that are not written.
struct RosProgram {
  const char* name;
  const char* node_class;  ///< that an experiment has for it
  const char* node_name;
  const char* message = "";       ///< "": must be given, or a mapping file says it
  const char* topic = "";         ///< "": must be given
  const char* command_rate = "";  ///< Hz
  const char* command_rate_key = "command_rate";
  const char* mapping_file = "";  ///< "": none
};

/// Null for another name.
const RosProgram* find_ros_program(std::string_view name);

/// Puts the program's defaults in this dialect into the node class's declaration.
void set_dialect_defaults(std::vector<ParameterDescription>& declared, std::string_view program,
                          Dialect dialect);
/// "Defaults in dialect ma: initial=0\n"; empty when they are those of dialect rma.
std::string dialect_note(std::string_view program);

/// Keys that stand in older files and never did anything, or do nothing any more.
std::vector<std::string> ignored_keys(std::string_view program);

/// Another name that an older program has for a key; null when there is none.
const char* older_spelling_of(std::string_view program, std::string_view key);

/// The name that a key of every program had in earlier versions; null when it had no other one.
const char* earlier_key(std::string_view key);
/// The same of a port of this program.
const char* earlier_port(std::string_view program, std::string_view port);

/// The file with the present names in the place of the earlier ones, as parse_music() gives it. A
/// key whose value is no truth value is left alone: it may belong to a foreign program.
/// @throws ConfigurationError when a key is written under both names.
MusicFile with_present_names(MusicFile file);

/// One-to-one weights between ports of different widths: what is surplus on either side has no
/// partner. Nothing when the widths are equal.
/// @throws ConfigurationError when strict; else it is said in a warning.
std::optional<WeightTable> uneven_one_to_one(std::uint32_t inputs, std::uint32_t outputs,
                                             bool strict);

}  // namespace spikeloop
