// One MUSIC application process: its keys, its ports as endpoints of a graph, its loop.
//
// The loop advances a graph tick by tick, h = music_timestep:
//
//     for t = 0, h, 2h, ... < stoptime:
//       wait until the clock shows t      the clock master; the others wait in MUSIC
//       step the graph over (t, t+h]      inputs hold what MUSIC has brought so far
//       tick MUSIC: t -> t+h              spikes of (t, t+h] and the signals' values at t+h go out
//
// Spikes of (t, t+h] are in the receiver's hands for its own step over (t, t+h]; a signal's value
// of t+h serves the receiver's step over (t+h, t+2h]: one tick a hop.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "spikeloop/core/graph.hpp"
#include "spikeloop/core/pacer.hpp"
#include "spikeloop/process/common_keys.hpp"
#include "spikeloop/status/status.hpp"

namespace spikeloop::music {

/// A section to check without MUSIC: nothing is started, connected or written.
struct SectionCheck {
  std::string file;
  std::string label;
};

/// A section whose program is a simulator with MUSIC of its own, such as NEST, and code of ours
/// beside it in one process. Setup, ports, ticks and finalize are the simulator's; ours are the
/// section's keys and checks, what the launcher is told, the clock, and what is recorded.
struct SimulatorsMusic {
  std::string file;
  std::string label;
};

/// The only section of a job, which needs neither MUSIC nor MPI.
struct SectionAlone {
  std::string file;
  std::string label;
};

class Process {
 public:
  /// Called by the loop; any may be left out.
  struct LoopHooks {
    std::function<void(TimeNs begin, TimeNs end)> before_step;  ///< the clock shows begin
    std::function<void(TimeNs begin, TimeNs end)> after_step;   ///< after MUSIC's tick
    std::function<void()> after_loop;  ///< before MUSIC's finalize, which may wait for the others
    std::function<nlohmann::json()> summary;  ///< an object for the run's summary.json
    /// Of a loop whose wait is somebody else's: then Loop::begin() is not called.
    std::function<Pacer::Report()> clock_report;
    std::function<nlohmann::json()> counters;  ///< an object in place of the graphs' counters
  };

  /// MUSIC's Setup (and MPI_Init). Afterwards argc and argv are what the section's `args` says.
  /// @throws ConfigurationError when the section asks for more than one process, unless
  /// `defaults.many_processes`.
  Process(int& argc, char**& argv, const CommonDefaults& defaults = {});
  /// Reads keys, files and widths as the section's program would, but has no MUSIC: run() returns
  /// when it has checked what it checks before it meets the others.
  /// @throws FileError, ConfigurationError for a file or label that is not there.
  Process(const SectionCheck& section, const CommonDefaults& defaults);
  /// After the simulator's Setup. Endpoints bring nothing and send nothing; run() and Loop turn as
  /// the others do, without a Runtime: the simulator ticks between begin() and exchange().
  /// @throws FileError, ConfigurationError for a file or label that is not there, and for several
  /// processes.
  Process(const SimulatorsMusic& section, const CommonDefaults& defaults);
  /// Without ports. @throws FileError, ConfigurationError for a file or label that is not there.
  Process(const SectionAlone& section, const CommonDefaults& defaults);
  ~Process();
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;

  /// The section's name; it names the node. Started without MUSIC: the program's name.
  const std::string& label() const;
  /// The basename of the section's `binary`.
  const std::string& program() const;
  /// True for a SectionCheck: then nothing outside is to be touched, no socket, no ROS.
  bool checking() const;
  /// False when the program was not started by MUSIC: it has no keys and no connections then.
  bool launched() const;
  /// Where the .music file lies, the user's own when a launcher made another one from it; empty
  /// when that is not known. Paths in it start there.
  std::string file_directory() const;

  /// The share of the section's work that this process has: of its np processes.
  Share share() const;
  /// Of a section with several processes: a node class that puts together what they compute, with
  /// the ports `in` and `out` of this kind. Spikes come out in the first process, signals in all.
  NodeClass gathering(PortKind kind) const;
  /// The Fortran handle of the communicator of the section's processes (MPI_Comm_f2c), for
  /// libraries that are to know of these alone.
  int communicator() const;
  /// The others of the section may say the same: the first one goes first, and ends the job.
  void let_the_first_speak() const;

  /// Must come before the first call of common().
  void set_defaults(const CommonDefaults& defaults);
  const CommonKeys& common() const;

  /// Those of these keys that the section, or else the file's global part, has.
  WrittenValues written(const std::vector<std::string>& names) const;
  /// Looks up each declared key and resolves it. @throws ConfigurationError as resolve().
  Parameters read(const std::vector<ParameterDescription>& declared,
                  const WeightLoader& load_weights = {}) const;

  /// Says which ports this program has, before it opens any.
  /// @throws ConfigurationError when the file connects another one: MUSIC would hang.
  void declare_ports(const std::vector<std::string>& names) const;
  /// True when the file connects this port, in whichever direction.
  bool connected_input(const std::string& port, PortKind kind) const;
  bool connected_output(const std::string& port, PortKind kind) const;
  /// The width that the file gives a connected port.
  /// @throws ConfigurationError when the port is not connected or its connection has no width.
  /// At most 16777216, as many as a table of weights can have.
  std::uint32_t width(const std::string& port) const;
  /// Where the file connects a port; nothing is known of one that is not connected.
  Location where(const std::string& port) const;
  /// Where its section begins.
  Location where() const;
  /// Where a key is written; nothing is known of one that is not.
  Location where_key(const std::string& key) const;

  /// Endpoints with one port, named as MUSIC names it. They must outlive run().
  /// @throws ConfigurationError when the port is not connected, has no width, or when the file uses
  /// it in the other direction.
  ///
  /// Across MUSIC no validity travels: an all-NaN block means "no value yet".
  /// Counters of a spike input: events_outside_port (dropped), events_without_time (dropped); of a
  /// spike output: stamps_moved (by the stamp guard).
  /// A signal arrives `delay_ticks` later; not given: the key `signal_delay`.
  /// Of several processes each gets all of an input and sends its share of a signal; spikes are
  /// gathered in the first, because MUSIC mixes up the ticks of several senders.
  std::unique_ptr<Source> signal_input(const std::string& port,
                                       std::optional<int> delay_ticks = std::nullopt);
  std::unique_ptr<Source> spike_input(const std::string& port);
  std::unique_ptr<Sink> signal_output(const std::string& port);
  std::unique_ptr<Sink> spike_output(const std::string& port);

  /// Adds recorders for whatever goes into the sinks of this graph when the key `record` says so:
  /// $SPIKELOOP_OUT/LABEL.h5. Call it when the description is complete.
  void attach_recorders(GraphDescription& description);

  /// For numbers that no port has, behind attach_recorders(): a signal in the same file, a row a
  /// call. Empty when nothing is recorded.
  std::function<void(TimeNs time, double value)> value_recorder(const std::string& stream,
                                                                const std::string& unit);

  /// What run() checks before it meets the others.
  /// @throws ConfigurationError when the file connects no port, or one that nothing here serves:
  /// MUSIC would hang; an unknown key when `strict`, which else is warned of.
  void check() const;

  /// Meets the other programs (barrier, Runtime), runs the loop to `stoptime` or to a stop request,
  /// finalizes, sends the final report. Returns 0. May be called once. For a SectionCheck only the
  /// checks. @throws as check().
  int run(Graph& graph, const LoopHooks& hooks = {});

  /// Tells the launcher what the process does, where Loop does not.
  void enter(status::Phase phase) const;
  /// Tells it that the loop has begun, before the first tick: what comes first may take any time.
  void say_begun() const;

  /// What run() does, in pieces, for a program whose own code stands between receiving and sending:
  ///
  ///     Process::Loop loop(process, {&receiving, &sending});
  ///     while (loop.begin()) {
  ///       receiving.step();  ...  sending.step();
  ///       loop.exchange();
  ///     }
  ///     loop.finish();
  class Loop {
   public:
    /// Meets the other programs. One a process. The graphs have the same tick; their counters are
    /// reported. @throws as check().
    Loop(Process& process, std::vector<const Graph*> graphs, LoopHooks hooks = {});
    ~Loop();
    Loop(const Loop&) = delete;
    Loop& operator=(const Loop&) = delete;
    /// Waits for the clock. False when the run is over: at `stoptime`, or a stop request.
    bool begin();
    /// MUSIC's tick.
    void exchange();
    /// Sends the final report, and finalizes MUSIC.
    void finish();

   private:
    struct State;
    std::unique_ptr<State> state_;
  };

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace spikeloop::music
