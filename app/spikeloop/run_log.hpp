// log.txt of a run folder: what a run said, with its times.
#pragma once

#include <atomic>
#include <mutex>
#include <string>
#include <string_view>

#include "spikeloop/status/status.hpp"

namespace spikeloop::app {

/// A line is in the file when write() returns, whatever becomes of the process:
///
///     2026-01-31T12:00:00.123Z      1.250 s  warning: not one message came on topic '/scan'
class RunLog {
 public:
  /// Begins a new file. @throws FileError when it cannot be made.
  explicit RunLog(const std::string& folder);

  /// Of what is written next; the newest progress that is known.
  void at(double simulated_s) { simulated_s_.store(simulated_s); }
  /// Adds the lines of `text`. A full disk loses them. From any thread.
  void write(std::string_view text) noexcept;
  /// For signal handlers; belongs to this object.
  int descriptor() const { return file_.get(); }

 private:
  std::mutex mutex_;
  Descriptor file_;
  std::atomic<double> simulated_s_{0};
};

}  // namespace spikeloop::app
