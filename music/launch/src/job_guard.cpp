// Starts and supervises the guard, and warns of stopped processes.
#include <fmt/format.h>
#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <thread>
#include <utility>

#include "guard_process.hpp"
#include "job_run.hpp"
#include "spikeloop/core/code.hpp"
#include "spikeloop/core/error.hpp"
#include "spikeloop/core/log.hpp"
#include "spikeloop/launch/programs.hpp"
#include "spikeloop/processes/descendants.hpp"
#include "supervision_thread.hpp"

namespace spikeloop::launch {
namespace {

constexpr const char* kUnguarded =
    "nothing stops the robot when its command adapter is killed or stopped";
/// Shortest time between two restarts of the guard.
constexpr std::chrono::seconds kRestartPeriod{3};
constexpr TimeNs kLongestStart = 5 * kNsPerSecond;
/// Signals wait for a restart.
constexpr TimeNs kLongestRestart = 1'500'000'000;
/// Adapters check every 20 ms whether the run is suspended.
constexpr std::chrono::milliseconds kSuspendGrace{100};
/// A longer turn of the launcher's loop counts as a pause: SIGSTOP, Ctrl-Z or a suspended machine.
constexpr std::chrono::seconds kLongestTurn{2};

bool commands_robot(const MusicFile& file) {
  return std::any_of(file.sections.begin(), file.sections.end(), [&file](const auto& section) {
    const Program* program = find_program(file, section);
    return program != nullptr && program->ros && (program->input || program->commands_robot);
  });
}

}  // namespace

void JobRun::start_guard() {
  if (!commands_robot(effective_.file)) {
    return;
  }
  const std::string path = scratch_.path() + "/supervision";
  supervision_ = std::make_unique<SupervisionThread>(path);
  ros_environment_[status::kSupervisionVariable] = path;
  make_guard(kLongestStart);
  if (guard_) {
    restarts_guard_ = true;
    ros_environment_[guard::kSocketVariable] = guard_socket(scratch_.path());
  }
}

void JobRun::make_guard(TimeNs longest) {
  const auto log = [this](log::Level level, const std::string& text) {
    log_ << "guard: " << text << std::endl;
    log::write(level, text);
  };
  const auto stopped = [this] { ++stopped_by_guard_; };
  try {
    guard_ = std::make_unique<GuardProcess>(scratch_, with_environment({}).environment,
                                            GuardProcess::Events{log, stopped}, longest);
    supervision_->set_guard(guard_->pid());
    guard_failed_ = false;
  } catch (const TransportError& error) {
    if (std::exchange(guard_failed_, true)) {
      return;
    }
    log::warning("{}", lengthened(error.what(), fmt::format("; {}", kUnguarded)));
  }
}

void JobRun::watch_guard() {
  if (supervision_ && supervision_->has_continued_guard()) {
    log::warning("spikeloop-guard had been stopped (SIGSTOP); it was continued");
  }
  if (guard_) {
    const bool alive = guard_->read();
    if (alive && !guard_->hangs()) {
      return;
    }
    supervision_->set_guard(0);
    guard_->kill();
    guard_.reset();
    log::warning("spikeloop-guard {}; {}{}", alive ? "hangs" : "has ended",
                 outcome_ ? "" : "it is started again. Until then ", kUnguarded);
  }
  if (!guard_ && restarts_guard_ && !outcome_ && Clock::now() >= next_guard_) {
    next_guard_ = Clock::now() + kRestartPeriod;
    make_guard(kLongestRestart);
  }
}

void JobRun::end_guard() {
  if (supervision_) {
    supervision_->set_guard(0);
  }
  if (guard_) {
    guard_->end();
    guard_.reset();
  }
}

void JobRun::warn_of_stopped_process() {
  const pid_t stopped = supervision_ ? supervision_->stopped_process() : 0;
  // A process that `fg` has just continued may still be reported.
  if (stopped != 0 && stopped != reported_stopped_ && is_stopped(stopped)) {
    log::warning(
        "process {0} ({1}) has been stopped (SIGSTOP); the robot is stopped until it continues:  "
        "kill -CONT {0}",
        stopped, stopped == mpirun_->tree().pid() ? starter() : kSubreaperName);
  }
  reported_stopped_ = stopped;
}

void JobRun::suspend() {
  if (!options_.hostfile.empty()) {
    log::warning("Ctrl-Z does not suspend a run on several hosts; Ctrl-C stops it");
    return;
  }
  log::info("suspended by Ctrl-Z; fg, or  kill -CONT {},  continues", getpid());
  if (supervision_) {
    supervision_->suspend(true);
    std::this_thread::sleep_for(kSuspendGrace);
  }
  signal_programs(SIGSTOP);
  raise(SIGSTOP);  // SIGTSTP does nothing to a process that has no shell
  signal_programs(SIGCONT);
  if (supervision_) {
    supervision_->suspend(false);
  }
}

void JobRun::signal_programs(int number) {
  for (const Process* process : {mpirun_, robot_}) {
    if (process != nullptr && !process->gone()) {
      process->tree().signal_all(number);
    }
  }
}

void JobRun::allow_for_pause() {
  if (supervision_) {
    supervision_->turn();
  }
  const auto now = Clock::now();
  const auto turn = now - std::exchange(turned_, now);
  if (turn > kLongestTurn) {
    started_ += turn;
    prepared_ += turn;
    died_since_ += turn;
    for (auto* const since : {&stopping_since_, &failed_since_, &reported_since_}) {
      if (*since) {
        **since += turn;
      }
    }
    state_.allow_for_pause(turn);
  }
}

std::string JobRun::unstopped_robot() const {
  const bool any = supervision_ && supervision_->robots() > stopped_by_guard_;
  return any ? "; no stop command could be sent to the robot: stop it by hand" : "";
}

}  // namespace spikeloop::launch
