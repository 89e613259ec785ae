// The file that a job really runs: the user's, with what the launcher knows better than a user
// should have to.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "spikeloop/config/music_file.hpp"

namespace spikeloop::launch {

/// What the command line says of a run. It holds over whatever the file says.
struct RunOptions {
  std::optional<double> duration_s;        ///< `stoptime` of every section
  std::optional<std::uint64_t> seed;       ///< `seed` of every section
  std::optional<double> real_time_factor;  ///< `rtf` of every section
  std::optional<int> ros;                  ///< `ros` of sections that speak ROS: 1 or 2
  std::string ros_arguments{};             ///< `ros_arguments` of these sections; empty: theirs
  bool record = false;                     ///< `record=true` in our sections
  bool data_stamp = true;                  ///< add the data_stamp connection
  bool strict = false;                     ///< `strict=true` in every section
};

struct EffectiveFile {
  MusicFile file;
  std::vector<std::string> warnings;
};

/// Adds to a file whose structure has been checked, never changing a key that it has (the options
/// aside):
/// - sections downstream-first (MUSIC.md: any other order costs a tick of wall time a hop);
/// - `SENSOR.data_stamp -> COMMAND.data_stamp [1]` from the first ros_sensor_adapter that reaches a
///   ros_command_adapter, so that nobody runs far ahead and the age of data is measured;
///   `pipeline_ticks` for the latter: the ticks by which data_stamp is delayed to arrive with the
///   data; `watchdog` for it where ticks are so long that the pauses between MUSIC's batches would
///   stop the robot;
/// - `clock_master`: of sections that are connected with each other exactly one waits for the clock:
///   the first source, as ros_sensor_adapter, or else our program that lies furthest upstream;
/// - `stoptime=1` in our sections of dialect ma that have none;
/// - `stamp_guard=false` where all receivers of a sender's spikes are ours;
/// - `accept_latency`: 0, but in a cycle so much that MUSIC's rule holds, that the acceptable
///   latencies add up to at least the ticks around the cycle.
/// @throws ConfigurationError for a dialect=auto that cannot choose
EffectiveFile make_effective(MusicFile file, const RunOptions& options);

/// The sections as the user wrote them: the effective file has an order of its own.
std::vector<const MusicSection*> in_written_order(const MusicFile& file);

/// The number in a key of a section; none: it is not written, or cannot be read, of which the
/// program itself says more.
std::optional<double> number_of(const MusicFile& file, const MusicSection& section,
                                const char* name, const char* unit);

/// The tick of a section: `music_timestep`; 1 ms when there is none that can be read.
std::int64_t tick_of(const MusicFile& file, const MusicSection& section);

/// `stoptime` of a section; none: it is not written, or cannot be read.
std::optional<std::int64_t> stop_time(const MusicFile& file, const MusicSection& section);

/// The smallest `stoptime` of any section in seconds; none: the job runs until it is stopped.
std::optional<double> total_time(const MusicFile& file);

}  // namespace spikeloop::launch
