// Shared memory in which the launcher shows that it supervises the job. Command adapters read it
// and stop their robots when the launcher is suspended or silent.
#pragma once

#include <atomic>
#include <cstdint>
#include <string>

#include "spikeloop/core/time.hpp"

namespace spikeloop::status {

/// The environment variable that holds the path of the file.
inline constexpr const char* kSupervisionVariable = "SPIKELOOP_SUPERVISION";

/// Wall time between two beats of the launcher.
inline constexpr TimeNs kSupervisionPeriod = 20'000'000;

struct SupervisionPage;

/// The launcher's side. All calls may be made from any thread.
class Supervision {
 public:
  /// Creates the file. The page counts as fresh. @throws FileError
  explicit Supervision(const std::string& path);
  ~Supervision();
  Supervision(const Supervision&) = delete;
  Supervision& operator=(const Supervision&) = delete;

  /// Records that the job is supervised at this wall time.
  void beat(TimeNs now);
  /// True: robots are stopped at once, whatever the beats are.
  void suspend(bool suspended);
  /// Number of robots that their adapters have not released. An adapter that was killed releases
  /// none.
  int robots() const;

 private:
  SupervisionPage* page_;
};

/// The adapter's side, one per robot.
class SupervisedRobot {
 public:
  enum class State : std::uint8_t {
    supervised,  ///< the launcher beats, or there is no launcher
    suspended,   ///< Ctrl-Z has suspended the launcher
    silent       ///< the launcher, mpirun or the process between them is stopped or hangs
  };

  /// Maps the file that SPIKELOOP_SUPERVISION names. Without it, or when the file is on another
  /// host, the state is always `supervised`.
  SupervisedRobot();
  ~SupervisedRobot();
  SupervisedRobot(const SupervisedRobot&) = delete;
  SupervisedRobot& operator=(const SupervisedRobot&) = delete;

  /// @param deadline wall time without a beat after which the launcher counts as silent
  State state(TimeNs now, TimeNs deadline) const;
  /// Releases the robot after its final stop. Safe to call from any thread.
  void release();

 private:
  SupervisionPage* page_ = nullptr;
  std::atomic<bool> released_{false};
};

}  // namespace spikeloop::status
