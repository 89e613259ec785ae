// What `spikeloop run` shows: programs' lines, warnings, how far the run is.
#pragma once

#include <chrono>
#include <mutex>
#include <optional>
#include <string>

#include "run_log.hpp"
#include "spikeloop/core/log.hpp"
#include "spikeloop/launch/job.hpp"

namespace spikeloop::app {

/// "12.3 of 60 s, real-time factor 0.99, 3 overruns"; without the factor in the first second of
/// wall time, without overruns where no clock can be overrun.
std::string progress_text(const launch::Progress& progress, bool follows_clock);

/// On a terminal one line is written over and over again; else one is added every 5 s. Public
/// functions are safe to call from any thread.
class Console {
 public:
  enum class Volume { quiet, normal, verbose };
  /// @param log gets all that is said, whatever the volume, but no progress; null: nobody does
  /// @param follows_clock ticks can be late
  explicit Console(Volume volume, RunLog* log = nullptr, bool follows_clock = true);

  void line(const launch::ProgramLine& line);
  void progress(const launch::Progress& progress);
  void log(log::Level level, std::string_view message);
  /// The last line of the run.
  void end(const launch::JobResult& result, const launch::Progress& progress);

 private:
  /// Makes room for a whole line where the progress line stands.
  void clear();
  void write(const std::string& text);

  void keep(const std::string& text);

  std::mutex mutex_;
  Volume volume_;
  RunLog* log_;
  bool follows_clock_;
  bool terminal_;
  bool shown_ = false;
  std::optional<std::chrono::steady_clock::time_point> last_;
};

/// Runs a job and shows it. Returns its exit code.
int run_job(launch::Job& job, Console::Volume volume, RunLog* log = nullptr,
            bool follows_clock = true);

}  // namespace spikeloop::app
