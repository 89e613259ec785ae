// What the processes of a job have told so far.
#pragma once

#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "process_group.hpp"
#include "spikeloop/launch/job.hpp"
#include "spikeloop/status/no_command.hpp"

namespace spikeloop::launch {

struct Failure {
  int exit_code = 1;
  std::string message;
  bool explained = true;  ///< false: mpirun knows more, and may still say it
};

/// "'brain' (brain.py) was killed by signal 9 (Killed)"
std::string killed_text(std::string_view who, int signal);

struct MpirunEnd {
  int exit_code = 0;
  bool killed = false;                ///< by a signal: the code is 128 + its number
  std::vector<std::string> missed{};  ///< sections whose programs ended before MPI knew them
  std::string program = "mpirun";     ///< or what runs in its place
};

/// Before what a program said last.
inline constexpr const char* kLastLine = "; its last line: ";

class JobState {
 public:
  /// `all_here`: everybody can report; else only those who do are expected to go on.
  explicit JobState(const MusicFile& file, bool all_here = true);

  /// Takes a datagram. Returns true when there is new progress.
  bool take(const nlohmann::json& message, Clock::time_point now = Clock::now());
  /// Takes a line that a program printed under mpirun, or mpirun itself.
  void take(const OutputLine& line);

  const Progress& progress() const { return progress_; }
  /// The first failure that a process reported.
  const std::optional<Failure>& failure() const { return failure_; }
  /// Whether a program has called MPI_Abort, which ends the job; mpirun may hang in doing so.
  bool aborted() const { return aborted_.has_value(); }
  /// Process ids of those that have said that they live.
  std::vector<pid_t> pids() const;
  /// Of those that still have to report, the first that has ended as `end_of` says.
  std::optional<Failure> first_death(const std::function<std::optional<int>(pid_t)>& end_of) const;
  /// Whether any program has said that it lives.
  bool any_started() const;
  /// Whether any program of the file has ticked.
  bool any_ticked() const;
  bool has_ticked(const std::string& label) const;
  /// Whether one stands still on purpose, for a clock, a robot or a viewer: the others wait for it.
  bool one_waits(Clock::time_point now = Clock::now()) const;
  /// Why the job has not begun; empty when everybody whose news we expect has ticked.
  std::string what_is_late(Clock::time_point now = Clock::now()) const;
  /// Why none of our programs has said that it lives, when these sections' programs do; true: but
  /// is stopped.
  std::string why_nobody_starts(const std::map<std::string, bool>& living) const;
  /// Who still reads files or compiles, and says so; empty: nobody.
  std::string who_prepares(Clock::time_point now = Clock::now()) const;
  /// Who has kept the job from going on for so long, and what everybody does; empty: nobody.
  std::string who_stands_still(Clock::duration longest, Clock::time_point now = Clock::now()) const;
  /// Who has left its loop before its time; empty: nobody.
  std::string who_ended_early() const;
  /// Adds the pause to the arrival times of all messages: none was read during the pause.
  void allow_for_pause(Clock::duration pause);
  /// Everybody whose report we expect has sent it.
  bool all_reported() const;
  /// Why a robot stood before the run's end, as its process says; nothing: none did.
  std::optional<std::string> stood_at_end() const;
  /// Files that could not be written, of all reports.
  std::vector<std::string> incomplete_files() const;
  /// nullopt if the job has driven its robot; see status::find_no_command.
  std::optional<status::NoCommand> find_no_command() const;
  /// What mpirun's end means.
  Failure explain(const MpirunEnd& end) const;
  /// Without the outcome: file, times, what the reports say.
  nlohmann::json summary() const;

 private:
  struct Process {
    std::string program;        ///< empty: not of this file
    bool ours = false;          ///< or has reported: we expect the other messages, too
    bool script = false;        ///< a user's that takes part by our package
    bool clock_master = false;  ///< waits for the clock
    bool terminated = false;    ///< by SIGTERM, as it says
    bool started = false;
    bool ticked = false;
    bool reported = false;
    std::optional<Clock::time_point> left{};  ///< when it called MUSIC's finalize
    pid_t pid = 0;
    std::optional<status::Phase> phase{};  ///< none: sends no heartbeats
    Clock::time_point heard{};             ///< of the last message
    Clock::time_point moved{};             ///< when its simulated time last changed
    /// When it last ceased to wait for the clock, a robot or a viewer.
    Clock::time_point left_wait{};
    double simulated_s = 0;
    std::uint64_t overruns = 0;
    nlohmann::json counters = nlohmann::json::object();
    nlohmann::json summary = nlohmann::json::object();
  };

  void take_phase(Process& process, std::optional<status::Phase> phase, Clock::time_point now);
  void take_time(Process& process, const nlohmann::json& message, Clock::time_point now);
  /// Of a foreign program that has left, while those of ours that it listens to go on: how far
  /// these are.
  std::optional<double> left_before_s(const Process& process, const std::string& label,
                                      double end_s) const;
  std::vector<std::string> standing_still(Clock::duration longest, Clock::time_point now) const;
  /// Foreign programs that have told nothing.
  std::vector<std::string> without_news() const;
  std::string shown(const std::string& label) const;
  bool take_progress(const std::string& label, const nlohmann::json& message);
  std::string named(int rank) const;
  /// "; its last line: TEXT", of standard error; empty when there was none.
  std::string last_line(const std::string& label) const;

  const MusicFile& file_;
  std::string clock_master_;  ///< the first section that waits for the clock; empty: unknown
  std::vector<std::string> order_;
  std::map<std::string, Process> processes_;
  Progress progress_;
  bool clock_master_heard_ = false;
  std::optional<Failure> failure_;
  std::string music_error_;
  std::string last_line_of_mpirun_;
  std::map<int, std::string> error_tail_;  ///< by rank, of standard error
  MpirunDiagnosis diagnosis_;
  std::string terminated_;      ///< label of the first that SIGTERM has ended
  std::optional<int> aborted_;  ///< the rank that called MPI_Abort
};

}  // namespace spikeloop::launch
