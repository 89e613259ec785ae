// Connection of a command adapter to the guard.
#pragma once

#include <atomic>
#include <mutex>
#include <string>
#include <vector>

#include "spikeloop/core/time.hpp"
#include "spikeloop/guard/protocol.hpp"

namespace spikeloop::guard {

/// Connection to the guard that SPIKELOOP_GUARD names. Without the variable every call does
/// nothing. A guard that is missing, ends or hangs causes a warning; the link connects again as
/// soon as a guard answers. All calls are safe from any thread, and none waits.
class Link {
 public:
  /// Waits until the guard is ready to stop the robot, at most 5 s.
  /// @throws TransportError if the guard cannot create a node of ROS 2, although this process has
  /// one
  explicit Link(const Hello& hello);
  Link(const Link&) = delete;
  Link& operator=(const Link&) = delete;

  /// True if a guard has accepted this adapter and answers.
  bool guarded() const { return guarded_.load(); }
  /// True if the guard is connected to the robot, or if there is no guard.
  bool reaches_robot() const { return !guarded() || reaches_.load(); }
  /// True if the guard can stop the robot: it answers, and is connected to the robot, if there is
  /// one.
  bool guards(bool robot_subscribes) const {
    return guarded() && (!robot_subscribes || reaches_.load());
  }
  /// Sends a beat, reads the packets of the guard, and connects again if the guard has ended. Must
  /// be called by the thread that stops the robot: the guard acts on the silence of that thread.
  /// Returns the time of the next call.
  TimeNs beat(TimeNs now);
  /// Sets the message with which the guard stops the robot. The next beat sends it to the guard.
  void set_stop(std::vector<std::byte> message);
  /// Makes the guard stop the robot at once, because this process cannot do so any more.
  void abandon();
  /// Ends the guard's watch. Call after the last stop command.
  void done();

 private:
  enum class State {
    off,      ///< no guard is configured, the first guard has refused, or the run is over
    missing,  ///< retries the connection at due_
    asked,    ///< hello was sent
    accepted
  };
  using Lines = std::vector<std::pair<bool, std::string>>;  ///< true: a warning

  // All functions below are called under the lock. They append texts to be printed to `lines`.
  bool connect(TimeNs now, Lines& lines);
  void read(TimeNs now, Lines& lines);
  void take(const Received& news, TimeNs now, Lines& lines);
  void lose(const std::string& reason, TimeNs now, Lines& lines);
  void check_silence(TimeNs now, Lines& lines);

  void send_stop();
  void leave(State state);

  Hello hello_;                ///< its `stop` is the newest one
  bool stop_is_known_ = true;  ///< True if the guard has been sent hello_.stop
  std::string path_;
  std::mutex mutex_;
  State state_ = State::off;
  Descriptor socket_;
  TimeNs due_ = 0;     ///< wall time of the next attempt (missing), deadline of the answer (asked)
  TimeNs heard_ = 0;   ///< wall time of the guard's newest packet
  bool lost_ = false;  ///< True after the warning that the robot is not guarded
  std::string ends_run_;       ///< Reason of the first guard to end the run; empty if none
  bool was_accepted_ = false;  ///< True if a guard has ever accepted this adapter
  bool reached_ = false;       ///< True if a guard has ever been connected to the robot
  std::atomic<bool> guarded_{false};
  std::atomic<bool> reaches_{false};
};

}  // namespace spikeloop::guard
