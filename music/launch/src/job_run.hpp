// One run of a job: starts what it needs, watches all of it, ends all of it.
#pragma once

#include <fstream>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include "job_state.hpp"
#include "process_group.hpp"
#include "spikeloop/launch/folders.hpp"
#include "spikeloop/launch/job.hpp"
#include "spikeloop/processes/reserved_port.hpp"
#include "spikeloop/processes/scratch_folder.hpp"
#include "start_watch.hpp"

namespace spikeloop::launch {

class GuardProcess;
class SupervisionThread;

class JobRun {
 public:
  /// The references must outlive it. @throws FileError
  JobRun(const EffectiveFile& effective, const JobOptions& options, const std::string& directory,
         const JobEvents& events);
  ~JobRun();

  /// An error, too, is a reason for the end; see result().
  void run();
  JobResult result() const;
  void fail(int exit_code, const std::string& reason);

 private:
  std::string translated(const std::string& text) const;
  /// What is started: mpirun, or the program in its place.
  std::string starter() const;
  void take_message(const nlohmann::json& message);
  void take_signal(int number);
  /// Shows a line and writes it to mpirun.log.
  void take_line(const std::string& label, const OutputLine& line);
  ProgramStart with_environment(ProgramStart start) const;
  /// Returns whether nothing speaks against a start.
  void add_incomplete_files();
  bool check();

  // Each returns whether the job goes on.
  bool start_ros();
  bool find_master();
  bool start_rosmaster();
  bool start_robot();
  bool is_experiment() const;
  int robot_ros() const;
  bool robot_is_there(const std::string& scan_topic);
  void start_programs();

  /// Whether a signal came before there was anything to stop.
  bool stopped_already();
  void supervise();
  void watch_start();
  /// Before MUSIC's Setup, with advice.
  std::string why_nobody_starts() const;
  void watch_progress();
  void watch_supervisor();
  void watch_failures();
  void watch_deaths();
  void watch_robot();
  /// Starts the guard and the thread whose beats the adapters read.
  void start_guard();
  /// @param longest wall time that the guard may need to start
  void make_guard(TimeNs longest);
  /// Starts a new guard if the guard has ended or hangs, and tries again if that fails.
  void watch_guard();
  void end_guard();
  /// Restarts the process that removes the scratch folder if the launcher is killed.
  void watch_cleaner();
  /// Warns when mpirun or its subreaper is stopped.
  void warn_of_stopped_process();
  /// Ctrl-Z: stops the robot, then all programs, then this process. Returns when it is continued.
  void suspend();
  void signal_programs(int number);
  /// Deadlines do not include the time for which this process was stopped.
  void allow_for_pause();
  /// Text for the last line if a robot was left driving. Empty otherwise.
  std::string unstopped_robot() const;
  bool robot_ended() const;
  /// The job's, when the robot ended too early with `code`: an end that was good for the robot is
  /// none for the job.
  static int exit_code_without_robot(int code);
  void watch_end();
  void judge_commands();
  void watch_stop();
  /// Asks every program of ours to leave its loop; ends all when there are no loops yet.
  void begin_stop();
  /// Kills what is left of the job, and waits until it has ended: the guard must outlive it.
  void kill_programs();
  void end_helpers();
  void end_helper(Process* helper);

  const EffectiveFile& effective_;
  const JobOptions& options_;
  const std::string& directory_;
  const JobEvents& events_;
  ScratchFolder scratch_;
  std::string folder_;  ///< scratch when there is no run folder
  std::string file_;    ///< the effective file
  std::ofstream log_;
  JobState state_;
  status::Receiver receiver_;
  ProcessGroup group_;
  std::map<std::string, std::string> ros_environment_;
  std::optional<ReservedPort> rosmaster_port_;
  Process* rosmaster_ = nullptr;
  Process* robot_ = nullptr;
  Process* mpirun_ = nullptr;
  std::unique_ptr<SupervisionThread> supervision_;  ///< null without a robot
  std::unique_ptr<GuardProcess> guard_;
  bool restarts_guard_ = false;     ///< false if the first guard could not be started
  bool guard_failed_ = false;       ///< the newest start failed, which was reported
  Clock::time_point next_guard_{};  ///< earliest time of the next restart
  int stopped_by_guard_ = 0;        ///< robots whose adapters had died
  pid_t reported_stopped_ = 0;      ///< stopped process that was reported; 0: none
  Clock::time_point turned_{};      ///< begin of the newest turn of supervise()
  std::optional<Failure> outcome_;  ///< none while all is well
  std::string remark_;              ///< see JobResult::remark
  int stop_signals_ = 0;
  std::chrono::steady_clock::time_point last_signal_{};
  Clock::time_point started_{};
  Clock::time_point prepared_{};  ///< when a program last said that it prepares itself
  std::optional<StartWatch> starting_;
  Clock::time_point counted_{};   ///< when we last saw whether all live
  std::optional<Failure> death_;  ///< the first, as long as mpirun says nothing of it
  Clock::time_point died_since_{};
  std::optional<Clock::time_point> stopping_since_;
  std::optional<Clock::time_point> failed_since_;
  std::optional<Clock::time_point> reported_since_;
  bool ended_after_reports_ = false;  ///< mpirun, which had nothing to do any more
};

}  // namespace spikeloop::launch
