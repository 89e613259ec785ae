// mpirun's command line, and what its output tells.
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "spikeloop/config/music_file.hpp"

namespace spikeloop::launch {

/// Where a job's processes run, and where Open MPI keeps its files.
struct Hosts {
  /// Takes Open MPI's session files and shared memory, so that a job that was killed leaves none
  /// behind. Empty: where Open MPI likes it, as it must be on several hosts.
  std::string scratch{};
  std::string hostfile{};  ///< Open MPI's; empty: this host
  /// Variables of the environment that programs on other hosts get, too; they must be set.
  std::vector<std::string> variables{};
};

/// Those of the environment that say where nodes of both ROS meet.
std::vector<std::string> ros_variables();

/// Those that a supervised job sets for its programs, and those of ROS 2 that are set.
std::vector<std::string> variables_of_job(const MusicFile& file);

/// `mpirun -np SUM ... music FILE`.
std::vector<std::string> mpirun_command(const MusicFile& file, const std::string& path,
                                        const Hosts& hosts);

/// Variables of an mpirun whose job is on this machine: it listens on 127.0.0.1 only
/// (music/mpirun_sockets.cpp), and PMIx keeps its data in the memory of mpirun.
std::map<std::string, std::string> mpirun_environment();

/// What `srun --multi-prog` reads: a line a section, its ranks and its program, which finds its
/// section by MUSIC's own options. @throws ConfigurationError as MusicFile::processes().
std::string multi_prog_text(const MusicFile& file, const std::string& path);
/// `srun -n SUM ... --multi-prog MULTI_PROG`, in `directory`.
std::vector<std::string> srun_command(const MusicFile& file, const std::string& multi_prog,
                                      const std::string& directory);

/// What every program started for a job finds in its environment: our programs first in PATH; our
/// package in PYTHONPATH; leave for root to use mpirun; Python's output unbuffered.
std::map<std::string, std::string> program_environment();

/// Where a program would be found; empty when it would not. A name with a '/' is looked up from
/// `directory`, others in `path`, a list as in PATH.
std::string find_executable(const std::string& program, const std::string& directory,
                            const std::string& path);

/// The section of an MPI rank; empty when there is none.
std::string label_of_rank(const MusicFile& file, int rank);

/// Text as one would type it into a shell.
std::string shell_text(const std::vector<std::string>& arguments);

/// One line of a job's output. `rank` is none for Open MPI's own, also from inside a program.
struct OutputLine {
  std::optional<int> rank;
  bool error = false;  ///< came from standard error
  std::string text;
  std::optional<int> speaker{};  ///< the rank inside which Open MPI speaks
};

/// Sorts what `mpirun --tag-output` prints into lines: it tags every piece that it reads of a
/// program, not every line.
class TaggedOutput {
 public:
  using Handler = std::function<void(OutputLine)>;
  /// `error`: which of mpirun's own streams this is.
  TaggedOutput(bool error, Handler handler) : error_(error), handler_(std::move(handler)) {}

  void feed(std::string_view bytes);
  /// Passes on unfinished lines.
  void finish();

 private:
  struct Source {
    int rank = -1;  ///< -1: mpirun itself
    bool error = false;
    auto operator<=>(const Source&) const = default;
  };
  void take_line(std::string_view line);
  void flush(const Source& source);

  bool error_;
  Handler handler_;
  std::string unfinished_;
  std::map<Source, std::string> pieces_;
};

/// Reads in mpirun's own lines which program ended first, and how.
class MpirunDiagnosis {
 public:
  void read(std::string_view line);

  std::optional<int> rank() const { return rank_; }
  std::optional<int> signal() const { return signal_; }
  /// Of a program that ended by itself or by MPI_Abort.
  std::optional<int> exit_code() const { return exit_code_; }

 private:
  std::optional<int> rank_;
  std::optional<int> signal_;
  std::optional<int> exit_code_;
};

}  // namespace spikeloop::launch
