// The keys that every MUSIC program of Spikeloop understands, beside its own.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "spikeloop/config/dialect.hpp"
#include "spikeloop/core/parameters.hpp"
#include "spikeloop/core/time.hpp"
#include "spikeloop/core/write_failures.hpp"

namespace spikeloop::music {

/// Defaults that differ between programs.
struct CommonDefaults {
  /// True for the program that waits for the wall clock: the source of a job.
  bool clock_master = false;
  /// True for a program whose predecessor asked for an acceptable latency of one tick: then that is
  /// the default of `accept_latency` in dialect rma.
  bool accept_one_tick = false;
  /// True for a program that may run in several processes (np).
  bool many_processes = false;
  /// True for a program that has a use for what `args` says.
  bool takes_arguments = false;
};

struct CommonKeys {
  std::optional<TimeNs> stoptime;  ///< none: run until stopped; in dialect ma never none
  TimeNs music_timestep = 1'000'000;
  bool barrier = true;  ///< MPI_Barrier on all programs between Setup and Runtime
  std::uint64_t seed = 1;
  Dialect dialect = Dialect::rma;  ///< whose defaults hold
  bool strict = false;             ///< what is only warned of becomes an error
  bool clock_master = false;       ///< this process waits for the wall clock
  double rtf = 1.0;                ///< real-time factor of the process that waits
  bool unpaced = false;            ///< sync=unpaced: nobody waits
  bool stamp_guard = true;    ///< keep outgoing spikes 1 us away from the begin of their interval
  TimeNs accept_latency = 0;  ///< of spike inputs
  TimeNs spike_delay = 0;     ///< of spike inputs: added to their times
  int signal_delay = 0;       ///< whole ticks by which MUSIC delays continuous inputs
  bool record = false;
  OnWriteFailure on_write_failure = OnWriteFailure::stop;  ///< for the recording
};

/// The declaration of these keys, for --help and the reference.
std::vector<ParameterDescription> common_parameters(const CommonDefaults& defaults = {});

/// `programs` are those of the job, which decide what dialect=auto means.
/// @throws ConfigurationError as resolve(), and for a tick that is not a whole number of
/// nanoseconds, a negative stoptime, a `sync` that this version does not have, and a dialect=auto
/// that cannot choose.
CommonKeys parse_common_keys(const WrittenValues& written, const CommonDefaults& defaults = {},
                             const std::vector<std::string>& programs = {});

}  // namespace spikeloop::music
