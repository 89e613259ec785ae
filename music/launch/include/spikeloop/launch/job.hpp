// A `.music` job from its start to its end: nothing of it outlives the Job, or the launcher.
#pragma once

#include <chrono>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "spikeloop/config/music_file.hpp"
#include "spikeloop/launch/effective_file.hpp"

namespace spikeloop::launch {

struct JobOptions {
  RunOptions run{};
  /// Run folder: effective.music, mpirun.log, summary.json, what programs record. Empty: none.
  std::string folder{};
  /// The contents of versions.json in the run folder; empty: none.
  std::string versions{};
  /// For every program of ours to tick for the first time; ten times as long while one of them says
  /// that it still reads files or compiles.
  std::chrono::milliseconds start_timeout{60'000};
  /// For the simulated time of any program of ours to go on, unless it waits for the clock; 0: for
  /// ever.
  std::chrono::milliseconds stall_timeout{60'000};
  /// Open MPI's file of hosts; empty: this host. What runs elsewhere cannot report: the deadlines
  /// then hold for what runs here.
  std::string hostfile{};
  /// The only section of the file, already checked, runs without mpirun and MUSIC.
  bool alone = false;
  /// `file` of summary.json: the file that the user wrote. Empty: the job's file.
  std::string source{};
  /// What is said of the file, for whoever wrote another one that it was made from. Empty: as it
  /// is.
  std::function<std::string(const std::string&)> translate{};
  bool roscore = false;  ///< start a ROS master when none answers
  /// Start spikeloop-robot when nobody publishes its scans, over the ROS that the file's programs
  /// speak: ROS 2, unless one of them speaks ROS 1.
  bool robot = false;
  std::string scan_topic = "/scan";  ///< what `robot_arguments` make of it
  /// Whether somebody publishes a topic of ROS 2; empty: nobody is asked.
  std::function<bool(const std::string& topic)> published_in_ros2{};
  std::vector<std::string> robot_arguments{};
};

/// How far the simulation is.
struct Progress {
  double simulated_s = 0;
  double wall_s = 0;
  std::optional<double> total_s;  ///< none: runs until it is stopped
  std::uint64_t overruns = 0;     ///< of all parts of the job

  double real_time_factor() const { return wall_s > 0 ? simulated_s / wall_s : 0; }
};

/// A line that a program printed.
struct ProgramLine {
  std::string label;   ///< section, "robot" or "mpirun"
  bool error = false;  ///< on standard error
  std::string text;
};

/// Called while the job runs; may be left out.
struct JobEvents {
  std::function<void(const Progress&)> progress{};
  std::function<void(const ProgramLine&)> line{};
};

struct JobResult {
  /// 0; 128 + n when signal n stopped the run; else that of the first failure: 2 configuration,
  /// 3 a partner is missing, silent or ended too early, 4 file, 5 node, 7 no message was usable,
  /// 128 + n for a program killed by signal n, or the code that the program gave.
  int exit_code = 0;
  std::string reason;      ///< one line
  std::string remark{};    ///< "no command was sent: ..." of a job that has finished; may be empty
  nlohmann::json summary;  ///< the contents of summary.json
};

class Job {
 public:
  /// @throws ConfigurationError for a file that MUSIC would not survive.
  Job(const MusicFile& file, JobOptions options);

  /// The file that is run.
  const EffectiveFile& effective() const { return effective_; }
  /// As one would type it.
  std::string command() const;

  /// Runs the job to its end. SIGINT, SIGTERM, SIGQUIT, SIGHUP and SIGUSR1 stop it: every program
  /// of ours leaves its loop; whatever is left after 2 s is ended, and killed 1 s later; a second
  /// signal, if it is not SIGUSR1, kills at once.
  /// What goes wrong is in the result; warnings go to the log.
  /// @throws FileError when the run folder cannot be written, or another run uses it.
  JobResult run(const JobEvents& events = {});

 private:
  JobOptions options_;
  EffectiveFile effective_;
  std::string directory_;
};

}  // namespace spikeloop::launch
