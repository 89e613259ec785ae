// What the launcher knows of the programs that sections name.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "spikeloop/config/music_file.hpp"
#include "spikeloop/core/node.hpp"

namespace spikeloop::launch {

/// The key that says where a program meets the world: a topic, an address.
struct ExternalAddress {
  std::string_view key{};
  std::string_view otherwise{};  ///< its default; empty: must be written
};

/// One of our programs.
struct Program {
  std::string_view name;             ///< as the last part of `binary`
  std::string_view node{};           ///< the class that it runs, if it runs one
  std::optional<PortKind> input{};   ///< none: has no MUSIC input
  std::optional<PortKind> output{};  ///< none: has no MUSIC output
  bool source = false;               ///< waits for the wall clock unless told otherwise
  bool ros = false;                  ///< speaks ROS, of the version in its key `ros`
  bool tells_age = false;            ///< has the output `data_stamp`
  bool measures_age = false;         ///< has the input `data_stamp`
  ExternalAddress external{};        ///< has no key: meets nobody
  bool commands_robot = false;       ///< whatever its ports are
  bool any_class = false;            ///< runs a class that the launcher does not know: any ports
  bool script = false;               ///< a user's, that takes part by our Python package
  bool rounds_times = false;         ///< of the spikes it gets, to microseconds
};

/// The names of our MUSIC programs that the launcher knows.
std::vector<std::string_view> program_names();

/// Null for a foreign program. The program spikeloop-node is known by its key `node`; it is ours
/// also when it runs a class that no other program runs, maybe of a plug-in. So is a script with a
/// line that imports the Python package spikeloop; with NEST in it, when it imports spikeloop.nest.
const Program* find_program(const MusicFile& file, const MusicSection& section);
/// Null for a foreign program or a label that no section has.
const Program* find_program(const MusicFile& file, std::string_view label);

/// The name under which a user knows what a section runs: its program's, or its script's.
std::string what_runs(const MusicFile& file, const MusicSection& section);

/// Where the section's program runs: its `wd`, seen from `directory`.
std::string working_directory(const MusicFile& file, const MusicSection& section,
                              const std::string& directory);

/// As the sender's table entry says, else as the receiver's; between foreign programs: false.
bool is_continuous(const MusicFile& file, const MusicConnection& connection);

/// Whether every section's program is one of ours: then SIGUSR1 stops the job cleanly.
bool all_ours(const MusicFile& file);
bool any_script(const MusicFile& file);
/// The version of ROS that a section's program speaks; 0: none.
int ros_version(const MusicFile& file, const MusicSection& section);
bool needs_ros(const MusicFile& file, int version);

}  // namespace spikeloop::launch
