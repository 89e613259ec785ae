// What Process is made of. Only this module's sources see MUSIC's headers, which need MPI's C++
// bindings.
#pragma once

#include <mpi.h>

#include <map>
#include <memory>
#include <music.hh>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "job_file.hpp"
#include "recording.hpp"
#include "spikeloop/process/idle_ports.hpp"
#include "spikeloop/process/process.hpp"
#include "spikeloop/status/heartbeat.hpp"
#include "spikeloop/status/signals.hpp"
#include "spikeloop/status/status.hpp"

namespace spikeloop::music {

/// The processes of a section.
struct Ranks {
  MPI_Comm communicator = MPI_COMM_NULL;
  int rank = 0;
  int count = 1;

  Share share() const {
    return {static_cast<std::uint32_t>(rank), static_cast<std::uint32_t>(count)};
  }
};

struct Process::Impl {
  std::string label;
  std::string program;
  JobFile file;
  bool launched = false;
  bool checking = false;
  bool without_setup = false;  ///< a SectionCheck or SectionAlone, or a simulator has MUSIC
  bool running = false;        ///< the loop has begun
  Ranks ranks;
  CommonDefaults defaults;
  std::optional<CommonKeys> common;
  MUSIC::Setup* setup = nullptr;  ///< Runtime deletes it; null from then on
  std::map<std::string, MUSIC::Port*> probes;
  std::set<std::string> served;  ///< ports that have an endpoint
  std::set<std::string> asked;   ///< keys that some code has looked up
  std::optional<status::Sender> status;
  std::optional<status::Heartbeat> heartbeat;
  std::optional<status::TerminationHook> on_termination;
  std::unique_ptr<Recording> recording;

  /// @throws std::logic_error after run() has begun.
  MUSIC::Setup& open_setup() const;
  /// What the section's program is told of a key; nothing when it is not written.
  std::optional<std::string> key_text(const std::string& name) const;
  bool is_connected(const std::string& port);
  /// The file that MUSIC reads may have the port's earlier name.
  std::string name_in_file(const std::string& port);
  /// That the file gives a connected port; nothing when it gives none.
  std::optional<int> connection_width(const std::string& port);

  /// For width() and isConnected(). A name that may be unconnected must never be published as an
  /// event output (Runtime would crash), so the probe is always an event input.
  MUSIC::Port& probe(const std::string& port);
  /// @throws ConfigurationError as Process::signal_input() and its kin say.
  std::uint32_t checked_width(const std::string& port, Direction direction);
  /// Of a file, not of MUSIC's Setup.
  void take_section(const std::string& path, const std::string& name, const CommonDefaults& with);
  /// From now on the launcher hears of this process.
  void announce();
  /// @throws ConfigurationError when there are several, and the program runs in one.
  void check_processes() const;
  void check_recordable(bool record) const;
  /// Throws when MUSIC would hang: no port connected, or one that nothing serves.
  void check_ports() const;
  /// Throws when the file connects a port that is not among these.
  void check_port_names(const std::vector<std::string>& names) const;
  /// Warns of keys of the section that look like a slip of the pen; an error when strict.
  void check_keys(bool strict);
  void check_arguments(bool strict) const;
  /// "-> encoder.in [N]" with the program's label.
  std::string example(const std::string& port, Direction direction, const char* width) const;
};

/// Endpoints; ports.cpp. `name` is a signal's port in the file.
std::unique_ptr<Source> make_signal_source(MUSIC::Setup& setup, const std::string& name,
                                           const EndpointPort& port, TimeNs delay);
std::unique_ptr<Source> make_spike_source(MUSIC::Setup& setup, const EndpointPort& port,
                                          TimeNs accept_latency, TimeNs delay);
std::unique_ptr<Sink> make_signal_sink(MUSIC::Setup& setup, const std::string& name,
                                       const EndpointPort& port, const Ranks& ranks);
std::unique_ptr<Sink> make_spike_sink(MUSIC::Setup& setup, const EndpointPort& port,
                                      bool stamp_guard, const Ranks& ranks);

}  // namespace spikeloop::music
