#include "console.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdio>

#include "output.hpp"

namespace spikeloop::app {
namespace {

constexpr std::chrono::milliseconds kTerminalEvery{100};
constexpr std::chrono::seconds kFileEvery{5};
/// Before, the factor is that of the start: anything from 0 to 50.
constexpr double kMeaningfulWallTime_s = 1;

/// Ours write "LABEL: warning: ...", Python "UserWarning: ...", ROS "[ WARN] ...".
bool is_warning(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return std::tolower(c); });
  return text.find("warn") != std::string::npos;
}

}  // namespace

std::string progress_text(const launch::Progress& progress, bool follows_clock) {
  const double tenths = std::round(10 * progress.simulated_s) / 10;  // 3.0 of 2.952 s
  const std::string simulated = progress.total_s && tenths > *progress.total_s
                                    ? fmt::format("{:g}", progress.simulated_s)
                                    : fmt::format("{:.1f}", progress.simulated_s);
  const std::string total = progress.total_s ? fmt::format(" of {:g}", *progress.total_s) : "";
  const std::string factor =
      progress.wall_s < kMeaningfulWallTime_s
          ? ""
          : fmt::format(", real-time factor {:.2f}", progress.real_time_factor());
  const std::string overruns = follows_clock ? fmt::format(", {} overrun{}", progress.overruns,
                                                           progress.overruns == 1 ? "" : "s")
                                             : "";
  return fmt::format("{}{} s{}{}", simulated, total, factor, overruns);
}

Console::Console(Volume volume, RunLog* log, bool follows_clock)
    : volume_(volume),
      log_(log),
      follows_clock_(follows_clock),
      terminal_(isatty(STDERR_FILENO) != 0) {}

void Console::keep(const std::string& text) {
  if (log_ != nullptr) {
    log_->write(text);
  }
}

void Console::clear() {
  if (shown_) {
    put(stderr, "\r\x1b[K");
    shown_ = false;
  }
}

void Console::write(const std::string& text) {
  clear();
  put(stderr, text + "\n");
}

void Console::line(const launch::ProgramLine& line) {
  const std::lock_guard lock(mutex_);
  const bool labelled = line.text.starts_with(line.label + ": ");
  const std::string text = labelled ? line.text : fmt::format("{}: {}", line.label, line.text);
  keep(text);
  const bool own = line.label == "mpirun";
  const bool unwanted = volume_ == Volume::quiet && !is_warning(line.text);
  if (unwanted || (own && volume_ != Volume::verbose)) {
    return;
  }
  clear();
  put(line.error ? stderr : stdout, text + "\n");
}

void Console::progress(const launch::Progress& progress) {
  const std::lock_guard lock(mutex_);
  if (log_ != nullptr) {
    log_->at(progress.simulated_s);
  }
  const auto now = std::chrono::steady_clock::now();
  const bool soon =
      last_ && (terminal_ ? now - *last_ < kTerminalEvery : now - *last_ < kFileEvery);
  if (volume_ == Volume::quiet || soon) {
    return;
  }
  last_ = now;
  if (terminal_) {
    clear();
    put(stderr, progress_text(progress, follows_clock_));
    shown_ = true;
  } else {
    write("spikeloop: " + progress_text(progress, follows_clock_));
  }
}

void Console::log(log::Level level, std::string_view message) {
  const std::lock_guard lock(mutex_);
  keep(fmt::format("{}{}", level == log::Level::warning ? "warning: " : "", message));
  if (level == log::Level::warning) {
    write(fmt::format("spikeloop: warning: {}", message));
  } else if (volume_ != Volume::quiet) {
    write(fmt::format("spikeloop: {}", message));
  }
}

void Console::end(const launch::JobResult& result, const launch::Progress& progress) {
  const std::lock_guard lock(mutex_);
  const std::string remark = result.remark.empty() ? "" : "; " + result.remark;
  const std::string finished = "finished: " + progress_text(progress, follows_clock_) + remark;
  keep(result.exit_code != 0 ? fmt::format("{}; exit code {}", result.reason, result.exit_code)
                             : finished);
  if (result.exit_code != 0) {
    write("spikeloop: " + result.reason);
  } else if (volume_ != Volume::quiet) {
    write("spikeloop: " + finished);
  } else if (!result.remark.empty()) {
    write("spikeloop: warning: " + result.remark);
  }
  clear();
}

int run_job(launch::Job& job, Console::Volume volume, RunLog* log, bool follows_clock) {
  const BackgroundOutput output;
  Console console(volume, log, follows_clock);
  log::set_sink(
      [&console](log::Level level, std::string_view message) { console.log(level, message); });
  launch::Progress last;
  const launch::JobResult result =
      job.run({[&](const launch::Progress& progress) {
                 last = progress;
                 console.progress(progress);
               },
               [&console](const launch::ProgramLine& line) { console.line(line); }});
  log::set_sink({});
  console.end(result, last);
  return result.exit_code;
}

}  // namespace spikeloop::app
