#include "job_run.hpp"

#include <fmt/format.h>
#include <signal.h>
#include <string.h>
#include <sys/wait.h>

#include <algorithm>

#include "guard_process.hpp"
#include "section_checks.hpp"
#include "spikeloop/core/code.hpp"
#include "spikeloop/core/error.hpp"
#include "spikeloop/core/file.hpp"
#include "spikeloop/core/log.hpp"
#include "spikeloop/launch/check.hpp"
#include "spikeloop/launch/programs.hpp"
#include "spikeloop/processes/descendants.hpp"
#include "supervision_thread.hpp"

namespace spikeloop::launch {
namespace {

using std::chrono::seconds;

/// Within this while a second signal is the first one once more.
constexpr std::chrono::milliseconds kSameSignal{100};
/// How long programs may take to leave their loops and write what they have recorded. With what
/// follows a run ends within 5 s of the signal.
constexpr seconds kStopGrace{4};
/// How long they may take to end after their reports. MPI hangs then if the network has gone.
constexpr seconds kReportedStopGrace{2};
/// A foreign program is not asked, and keeps the others waiting.
constexpr seconds kForeignStopGrace{2};
/// A program that fails takes the others with it by MPI_Abort; this is for those that could not.
constexpr seconds kFailureGrace{3};
/// A program that says that it still prepares itself has so many times the start timeout.
constexpr int kMostPatience = 10;
constexpr const char* kBarrierAdvice =
    "A program that does not call MPI_Barrier(MPI_COMM_WORLD) between MUSIC's Setup and Runtime "
    "needs barrier=false in the file; one that starts slowly needs a longer --start-timeout";
constexpr const char* kSetupAdvice =
    "Every program of a job has to be a MUSIC program (Setup, Runtime, finalize); one that starts "
    "slowly needs a longer --start-timeout";
constexpr const char* kContinueAdvice = "kill -CONT PID lets a stopped program go on";
constexpr const char* kSlowStartAdvice = "Try again; a slow machine needs a longer --start-timeout";
/// mpirun ends a job within two seconds of a death; now and then it does not notice one. When it
/// has, a busy machine may hold up what it says.
constexpr seconds kDeathGrace{4};
constexpr seconds kNoticedDeathGrace{8};
constexpr std::chrono::milliseconds kCountInterval{500};
/// mpirun can hang when all is done.
constexpr seconds kEndGrace{10};
/// Foreign programs and scripts may have files to write.
constexpr seconds kForeignEndGrace{60};

}  // namespace

JobRun::JobRun(const EffectiveFile& effective, const JobOptions& options,
               const std::string& directory, const JobEvents& events)
    : effective_(effective),
      options_(options),
      directory_(directory),
      events_(events),
      folder_(options.folder.empty() ? scratch_.path() : make_folder(options.folder)),
      file_(folder_ + "/effective.music"),
      state_(effective.file, options.hostfile.empty()),
      receiver_(scratch_.path() + "/status"),
      group_(receiver_, {[this](const nlohmann::json& message) { take_message(message); },
                         [this](int number) { take_signal(number); }}) {
  write_file(file_, to_text(effective.file));
  if (!options.versions.empty()) {
    write_file(folder_ + "/versions.json", options.versions);
  }
  log_ = create_stream(folder_ + "/mpirun.log");
}

JobRun::~JobRun() = default;

void JobRun::fail(int exit_code, const std::string& reason) {
  if (!outcome_) {
    outcome_ = {exit_code, translated(reason)};
  }
}

std::string JobRun::translated(const std::string& text) const {
  return options_.translate ? options_.translate(text) : text;
}

std::string JobRun::starter() const {
  return options_.alone ? program_of(effective_.file.sections.front()) : "mpirun";
}

void JobRun::take_message(const nlohmann::json& message) {
  if (state_.take(message) && events_.progress) {
    events_.progress(state_.progress());
  }
}

void JobRun::take_signal(int number) {
  if (number == SIGTSTP) {
    suspend();
    return;
  }
  // Some batch systems repeat SIGUSR1, and GNU timeout sends every signal twice: no impatience.
  const auto now = std::chrono::steady_clock::now();
  if (stop_signals_ > 0 && now - last_signal_ < kSameSignal) {
    return;
  }
  const bool again = number != SIGUSR1 && stop_signals_ > 0;
  ++stop_signals_;
  last_signal_ = now;
  fail(128 + number, stopped_by(number));
  if (mpirun_ != nullptr && again) {
    mpirun_->tree().kill();
  }
}

void JobRun::take_line(const std::string& label, const OutputLine& line) {
  const std::string text = translated(line.text);
  log_ << label << ": " << text << std::endl;
  if (events_.line) {
    events_.line({label, line.error, text});
  }
}

ProgramStart JobRun::with_environment(ProgramStart start) const {
  start.environment = origin_environment(effective_.file.path);
  start.environment.insert(ros_environment_.begin(), ros_environment_.end());
  start.environment["SPIKELOOP_STATUS"] = scratch_.path() + "/status";
  // Recordings and learned weights would be gone with the scratch folder.
  start.environment["SPIKELOOP_OUT"] = options_.folder.empty() ? directory_ : folder_;
  start.kept = scratch_.descriptor();
  return start;
}

void JobRun::start_programs() {
  ProgramStart start;
  const bool here = options_.hostfile.empty();
  const std::string& first = effective_.file.sections.front().label;
  if (options_.alone) {
    start.arguments = {starter(), "--alone", file_, first};
  } else {
    start.arguments = mpirun_command(effective_.file, file_,
                                     {.scratch = here ? scratch_.path() : "",
                                      .hostfile = options_.hostfile,
                                      .variables = variables_of_job(effective_.file)});
  }
  start.directory = directory_;
  start = with_environment(start);
  if (here && !options_.alone) {
    start.environment.merge(mpirun_environment());
  }
  mpirun_ = &group_.start(start, [this](const OutputLine& line) {
    state_.take(line);
    const std::string other = options_.alone ? effective_.file.sections.front().label : "mpirun";
    take_line(line.rank ? label_of_rank(effective_.file, *line.rank) : other, line);
  });
  started_ = prepared_ = Clock::now();
  starting_.emplace(effective_.file.labels(), started_);
  if (supervision_) {
    // A program that runs alone is the adapter, which the guard watches.
    std::vector<pid_t> required{mpirun_->tree().subreaper()};
    if (!options_.alone) {
      required.push_back(mpirun_->tree().pid());
    }
    supervision_->require(required);
  }
}

void JobRun::run() {
  try {
    if (check() && start_ros() && !stopped_already()) {
      start_guard();
      start_programs();
      supervise();
    }
  } catch (const Error& error) {
    fail(error.exit_code(), error.what());
    kill_programs();
  } catch (...) {
    kill_programs();
    end_helpers();
    throw;
  }
  end_helpers();
  if (outcome_) {
    add_incomplete_files();
    outcome_->message = lengthened(outcome_->message, unstopped_robot());
  }
}

/// After Ctrl-C. Otherwise a program's failure is the outcome, and names the files.
void JobRun::add_incomplete_files() {
  if (stop_signals_ == 0) {
    return;
  }
  const auto& failure = state_.failure();
  const std::string files = failure && failure->exit_code == FileError::kExitCode
                                ? "; " + failure->message
                                : list_incomplete(state_.incomplete_files());
  if (!files.empty()) {
    outcome_->exit_code = FileError::kExitCode;
    outcome_->message = lengthened(outcome_->message, files);
  }
}

bool JobRun::check() {
  if (options_.alone) {
    return !outcome_;
  }
  Diagnostics diagnostics = check_together(effective_);
  for (const Diagnostic& warning : diagnostics) {
    if (!warning.is_error()) {
      log::warning("{}", translated(warning.text()));
    }
  }
  append(diagnostics, check_programs(effective_.file, directory_));
  // What they warn of there they say again when they run.
  SectionChecks sections(group_, effective_.file,
                         {file_, directory_, scratch_.descriptor(), is_experiment()});
  append(diagnostics, sections.run([this] { return outcome_.has_value(); }));
  if (!outcome_ && has_errors(diagnostics)) {
    const Diagnostic first = first_error(diagnostics, effective_.file.path);
    fail(first.exit_code, first.text());
  }
  return !outcome_;
}

bool JobRun::stopped_already() {
  group_.turn(Milliseconds{0});
  return outcome_.has_value();
}

void JobRun::supervise() {
  turned_ = Clock::now();
  while (!mpirun_->gone()) {
    group_.turn(Milliseconds{100});
    allow_for_pause();
    watch_supervisor();
    watch_failures();
    watch_deaths();
    watch_start();
    watch_progress();
    watch_robot();
    watch_guard();
    warn_of_stopped_process();
    watch_cleaner();
    watch_end();
    watch_stop();
  }
  group_.turn(Milliseconds{0});
  watch_supervisor();
  const int status = mpirun_->tree().status().value_or(1);
  const int code = exit_code(status);
  if (options_.alone && code == 0 && !outcome_ && !state_.all_reported()) {
    fail(3, with_code(Code::partner_failed,
                      "{} has ended before its time, and has not said why; look for an exit() in a "
                      "plug-in",
                      starter()));
  }
  if (state_.failure() || (code != 0 && !ended_after_reports_)) {
    const auto missed = state_.any_started() ? std::vector<std::string>{} : starting_->missed();
    const Failure failure = state_.explain({code, WIFSIGNALED(status), missed, starter()});
    const bool far = !options_.hostfile.empty() && !state_.any_started();
    fail(failure.exit_code,
         far ? lengthened(failure.message, fmt::format("; see {}/mpirun.log", folder_))
             : failure.message);
  }
  if (const auto reason = state_.stood_at_end()) {
    fail(3, *reason);
  }
  if (!outcome_) {
    judge_commands();
  }
}

void JobRun::judge_commands() {
  const auto no_command = state_.find_no_command();
  if (no_command && no_command->nothing_usable) {
    fail(UnusableMessages::kExitCode, no_command->reason);
  } else if (no_command) {
    remark_ = no_command->reason;
  }
}

void JobRun::watch_start() {
  const auto now = Clock::now();
  if (!state_.who_prepares().empty() && now - started_ < kMostPatience * options_.start_timeout) {
    prepared_ = now;
  }
  if (state_.one_waits()) {
    prepared_ = now;  // the others have their time when it goes on
  }
  const bool before_setup = !state_.any_started() && options_.hostfile.empty() && !options_.alone;
  if (before_setup && starting_->is_due(now)) {
    starting_->take(living_sections(mpirun_->tree().pid()), now);
  }
  const bool too_late = now - prepared_ >= options_.start_timeout;
  const bool one_has_gone = before_setup && starting_->one_has_gone(now);
  if (outcome_ || failed_since_ || !(too_late || one_has_gone)) {
    return;
  }
  const std::string reason = before_setup ? why_nobody_starts() : state_.what_is_late();
  if (reason.empty()) {
    return;
  }
  const bool explained = reason.find(kLastLine) != std::string::npos;
  const double limit_s = std::chrono::duration<double>(options_.start_timeout).count();
  fail(3,
       with_code(
           Code::partner_failed, "the job has not begun{}; {}{}",
           too_late ? fmt::format(" within {:g} s", limit_s) : "", reason,
           before_setup || options_.alone || explained ? "" : fmt::format(". {}", kBarrierAdvice)));
  mpirun_->tree().end();
}

std::string JobRun::why_nobody_starts() const {
  if (is_stopped(mpirun_->tree().pid())) {
    return fmt::format("{} has been stopped (SIGSTOP). {}", starter(), kContinueAdvice);
  }
  const auto living = starting_->living();
  const bool stopped = std::ranges::any_of(living, [](const auto& entry) { return entry.second; });
  return fmt::format("{}. {}", state_.why_nobody_starts(living),
                     living.empty() ? kSlowStartAdvice
                     : stopped      ? kContinueAdvice
                                    : kSetupAdvice);
}

void JobRun::watch_progress() {
  if (outcome_ || failed_since_ || !state_.any_ticked()) {
    return;
  }
  if (const std::string early = state_.who_ended_early(); !early.empty()) {
    fail(3, early);
    return;
  }
  const auto longest = options_.stall_timeout;
  const std::string still = longest.count() == 0 ? "" : state_.who_stands_still(longest);
  if (!still.empty()) {
    fail(3, with_code(Code::partner_failed,
                      "the job has stood still for {:g} s, {}. A program whose ticks take longer "
                      "needs a longer --stall-timeout",
                      std::chrono::duration<double>(longest).count(), still));
    mpirun_->tree().end();
  }
}

/// The kernel terminates the programs with the process that supervises them (subreaper.hpp); none
/// of them is the cause.
void JobRun::watch_supervisor() {
  mpirun_->tree().gone();  // reads the news
  if (const auto signal = mpirun_->tree().subreaper_killed_by()) {
    fail(128 + *signal,
         killed_text(fmt::format("{}, which supervises the programs of the job,", kSubreaperName),
                     *signal));
  }
}

void JobRun::watch_cleaner() {
  if (scratch_.restart_remover()) {
    log::warning("the process that removes {} at the end was killed; it is started again",
                 scratch_.path());
  }
}

void JobRun::watch_failures() {
  if (!failed_since_ && (state_.failure() || state_.aborted())) {
    failed_since_ = Clock::now();
  }
  if (failed_since_ && Clock::now() - *failed_since_ > kFailureGrace) {
    mpirun_->tree().end();
  }
}

void JobRun::watch_deaths() {
  const auto now = Clock::now();
  if (outcome_ || failed_since_ || !options_.hostfile.empty() || now - counted_ < kCountInterval) {
    return;
  }
  counted_ = now;
  if (!death_) {
    death_ = state_.first_death(end_of);  // the others are ended after it
    died_since_ = now;
  } else if (!state_.first_death(end_of)) {
    death_.reset();  // it has reported: all is well
  } else if (now - died_since_ > (death_->explained ? kDeathGrace : kNoticedDeathGrace)) {
    fail(death_->exit_code, death_->message);
    mpirun_->tree().end();
  }
}

bool JobRun::robot_ended() const {
  return robot_ != nullptr && robot_->gone();
}

void JobRun::watch_robot() {
  if (!robot_ended() || outcome_ || reported_since_) {
    return;
  }
  if (const auto& failure = state_.failure()) {
    fail(failure->exit_code, failure->message);
    return;
  }
  const int status = robot_->tree().status().value_or(1);
  const int code = exit_code(status);
  if (const auto signal = robot_->tree().subreaper_killed_by()) {
    fail(128 + *signal,
         killed_text(fmt::format("{}, which supervises the simulated robot,", kSubreaperName),
                     *signal));
    return;
  }
  if (WIFSIGNALED(status)) {
    fail(code, killed_text("robot: the simulated robot", WTERMSIG(status)));
    return;
  }
  const std::string& last = robot_->error_tail();
  fail(exit_code_without_robot(code),
       with_code(Code::partner_failed, "robot: ended before the job, with exit code {}{}", code,
                 last.empty() ? "" : "; its last line: " + last));
}

void JobRun::watch_end() {
  if (!reported_since_ && state_.all_reported()) {
    reported_since_ = Clock::now();
  }
  const bool quick = all_ours(effective_.file) && !any_script(effective_.file);
  const auto grace = quick ? kEndGrace : kForeignEndGrace;
  if (reported_since_ && Clock::now() - *reported_since_ > grace) {
    log::warning("{} has not ended {} s after the last report: it is ended now", starter(),
                 grace.count());
    reported_since_ = Clock::now();
    ended_after_reports_ = true;
    mpirun_->tree().end();
  }
}

void JobRun::watch_stop() {
  // A program of the job that failed takes the others with it.
  if (outcome_ && !stopping_since_ && (!state_.failure() || robot_ended())) {
    stopping_since_ = Clock::now();
    begin_stop();
  }
  const auto grace = all_ours(effective_.file) ? kStopGrace : kForeignStopGrace;
  const bool all_done = reported_since_ && !any_script(effective_.file) &&
                        Clock::now() - *reported_since_ > kReportedStopGrace;
  if (stopping_since_ && (all_done || Clock::now() - *stopping_since_ > grace)) {
    mpirun_->tree().end();
  }
}

void JobRun::begin_stop() {
  if (!state_.any_ticked()) {
    // SIGUSR1 would be lost on a program that is still to be started, which would then drive.
    mpirun_->tree().end();
    return;
  }
  if (all_ours(effective_.file)) {
    mpirun_->tree().signal(SIGUSR1);
    return;
  }
  // A foreign program may not know what to do with it: NEST dies.
  for (const pid_t pid : state_.pids()) {
    ::kill(pid, SIGUSR1);
  }
}

JobResult JobRun::result() const {
  JobResult result;
  result.exit_code = outcome_ ? outcome_->exit_code : 0;
  result.reason = outcome_ ? outcome_->message : "finished";
  result.remark = outcome_ ? "" : remark_;
  result.summary = state_.summary();
  if (!options_.source.empty()) {
    result.summary["file"] = options_.source;
  }
  result.summary["exit_code"] = result.exit_code;
  result.summary["exit_reason"] =
      result.remark.empty() ? result.reason : fmt::format("{}; {}", result.reason, result.remark);
  return result;
}

}  // namespace spikeloop::launch
