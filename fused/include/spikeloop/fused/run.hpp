// The nodes of an experiment that share this process; in the fused layout all but simulators. They
// are one graph, and the loop is
//
//     for t = 0, h, 2h, ... < duration:
//       wait until the clock shows t        sync: realtime, sim_time; the others do not wait
//       messages of t arrive                from the robot in this process, or from ROS
//       step the graph over (t, t+h]
//       commands of t+h leave
//       other processes take what was sent in (t, t+h], and give theirs
//       the robot advances to t+h, on the commands of t      in this process, or sync: lockstep
//
// With sync: lockstep nothing else happens, so that a run can be repeated to the bit, as fast as
// the machine allows.
#pragma once

#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "spikeloop/core/time.hpp"
#include "spikeloop/core/write_failures.hpp"
#include "spikeloop/experiment/experiment.hpp"
#include "spikeloop/fused/other_processes.hpp"
#include "spikeloop/fused/transport.hpp"
#include "spikeloop/robot/spectators.hpp"

namespace spikeloop::fused {

struct Progress {
  TimeNs simulated = 0;
  TimeNs wall = 0;
  std::uint64_t overruns = 0;
};

// Files of a run folder.
inline constexpr const char* kMessagesFile = "messages.mcap";
inline constexpr const char* kExperimentFile = "experiment.yaml";  ///< the file that was run
inline constexpr const char* kFilesFolder =
    "experiment-files";  ///< copies of what the experiment was made of

struct RunOptions {
  /// Run folder, which must be there: what nodes put out, messages.mcap, trajectory.csv,
  /// world.json, experiment.yaml, resolved.json, summary.json. Empty: none.
  std::string folder{};
  bool record = true;
  /// Whose nodes run here; empty: those of the layout's first process, which writes resolved.json,
  /// experiment.yaml and summary.json.
  std::string process{};
  /// Who watches the robot in this process.
  robot::SpectatorOptions spectators{};
  /// An object that resolved.json has beside the experiment: versions, machine.
  nlohmann::json about{};
  /// Asked for every output of a node ("encoder.out") and for "NODE.command" of every command: a
  /// sink that takes what it puts out.
  std::function<std::unique_ptr<Sink>(const std::string& end, PortKind kind, std::uint32_t width)>
      observe{};
  /// As live::Feed; empty: there is no live view.
  std::string live_folder{};
  /// Failed writes of all files. `on_write_failure` selects the reaction.
  std::shared_ptr<WriteFailures> failures = std::make_shared<WriteFailures>();
};

struct RunResult {
  int exit_code = 0;
  std::string reason;  ///< one line; empty when all went well
  nlohmann::json summary;
  std::string remark{};  ///< "no command was sent: ..." of a run that has finished; may be empty
};

/// Called while it runs; may be left out.
struct RunEvents {
  std::function<void(TimeNs simulated)> ticked{};   ///< after every tick
  std::function<void(const Progress&)> progress{};  ///< ten times a second, and at the end
  std::function<bool()> stop{};                     ///< asked every tick
  /// Before (true) and after a time for which a viewer holds up the run: pause, or a low speed.
  std::function<void(bool waits)> waits{};
  /// Before summary.json is written: who stopped the run may say so.
  std::function<void(RunResult&)> ended{};
};

/// What carries the messages of an experiment without ROS: its robot, its bag, or nothing.
/// @throws Error: no such world, no such file.
std::unique_ptr<Transport> make_transport(const experiment::Experiment& experiment,
                                          const RunOptions& options);

/// A run, tick by tick. The arguments must outlive it.
class Run {
 public:
  /// @param others none: the experiment runs in this process alone
  /// @throws Error when it cannot begin: a file, a world, a ROS master.
  Run(const experiment::Experiment& experiment, Transport& transport, const RunOptions& options,
      const RunEvents& events = {}, OtherProcesses* others = nullptr);
  ~Run();
  Run(const Run&) = delete;
  Run& operator=(const Run&) = delete;

  /// Waits for the clock, and advances by a tick. False: the duration is over, `stop` wants it, or
  /// a tick failed; finish() says which.
  bool tick();
  TimeNs time() const;
  /// Stops the robot, closes the recordings, writes summary.json. To be called once.
  RunResult finish();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Runs to the end of the duration, or until `stop`. What goes wrong meanwhile is in the result;
/// the robot is stopped in every case.
/// @throws Error as Run.
RunResult run(const experiment::Experiment& experiment, const RunOptions& options,
              const RunEvents& events = {}, OtherProcesses* others = nullptr);

/// The same with messages that come and go elsewhere.
RunResult run(const experiment::Experiment& experiment, Transport& transport,
              const RunOptions& options, const RunEvents& events = {},
              OtherProcesses* others = nullptr);

/// Where a file of the experiment is in kFilesFolder: its path from the experiment's folder. Empty:
/// it lies elsewhere, and is not copied.
std::string copy_of(const std::string& file, const std::string& experiment_file);

/// Every key with its value, every connection with its width and delay, what files it was made of.
nlohmann::json resolved_json(const experiment::Experiment& experiment);

}  // namespace spikeloop::fused
