// Limits commands, decides when they are sent, and stops the robot. A function publishes the
// messages over ROS 1 or ROS 2.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <functional>
#include <limits>
#include <mutex>
#include <optional>
#include <span>
#include <vector>

#include "spikeloop/command/command_settings.hpp"
#include "spikeloop/command/stop_reason.hpp"
#include "spikeloop/core/node.hpp"

namespace spikeloop::command {

inline constexpr TimeNs kContinuedPause = 1'500'000'000;

/// Maximum age of a measured position. If it is older, a stop holds the last command.
inline constexpr TimeNs kMeasuredAge = 500'000'000;

/// Thread-safe. `publish` is called under the lock, so it must not block.
///
/// Priority: the end of the run, the pause after SIGCONT, the emergency stop, a manual command, a
/// stop requested by the loop, a missing tick, the command of the network.
class CommandChannel {
 public:
  using Publish = std::function<void(std::span<const double>)>;

  CommandChannel(const CommandSettings& settings, Publish publish);

  /// Takes the command of a tick. Returns the time at which to call poll() if no other function is
  /// called before. A value that is not finite stops the robot.
  TimeNs command(std::span<const double> values, TimeNs now);

  /// Sends the stop command at once, without limits and minimum intervals, and repeats it (see
  /// CommandGate) until the robot is driven again: a message can be lost, and a robot can connect
  /// later. After `continued` no command is sent for kContinuedPause: mpirun sends SIGCONT when a
  /// program has died, and SIGTERM 1 s later. After `terminated` and `ended` nothing is sent.
  /// Before the first command only reasons from outside the loop send a stop command. During manual
  /// commands, reasons of the loop and `silent` take effect when the manual command ends.
  TimeNs stop(StopReason reason, TimeNs now);

  /// Stops the robot as long as the emergency stop has a reason.
  void hold(std::optional<StopReason> reason, TimeNs now);

  /// Sends a manual command within the bounds. The manual command replaces the network's until its
  /// time-out. A value that is not finite stops the robot.
  void override_with(std::span<const double> values, TimeNs now);

  /// Newly measured positions of the components that a stop holds; NaN: not measured now.
  void measure(std::span<const double> positions, TimeNs now);
  /// Values of the stop command: of the current stop, or of a stop at `now` if the robot is driven.
  /// They are fixed when a stop begins, so that a joint that yields is not followed. NaN: the
  /// position is unknown.
  std::vector<double> stop_values(TimeNs now) const;
  /// True while the commands of the network or manual ones are sent. May be called by `publish`.
  bool drives() const { return drives_.load(); }

  /// Called when a robot has subscribed. The next command is sent in any case, and slews from the
  /// stop command.
  void restart_commands(TimeNs now);
  /// Called when the nodes before the command are reset. A command without a value then stops no
  /// robot before the next command with a value, as at the start of a run.
  void allow_no_value();

  /// Sends messages that are due between ticks. Returns the time of the next call.
  TimeNs poll(TimeNs now);
  /// Repeats the stop command of a stopped robot at once: while simulated time is paused, no
  /// repetition becomes due.
  void repeat_stop(TimeNs now);

  struct Standing {
    /// Reason for the stop; nullopt while the robot is driven, and before the first command.
    std::optional<StopReason> stopped;
    bool overridden = false;  ///< a manual command is valid
    bool driven = false;      ///< a command of the network or a manual one has been sent
  };
  Standing standing() const;
  enum class NetworkCommand : std::uint8_t {
    unused,     ///< the robot is stopped, or driven manually
    held_back,  ///< a change waits for min_interval
    sent        ///< the robot has the newest command, apart from changes within the deadband
  };
  NetworkCommand network_command() const;
  /// Total duration of all stops that have ended.
  TimeNs stopped_time() const;
  /// First value that was beyond a minimum or maximum.
  std::optional<Limiter::Cut> first_cut() const;

  /// commands: number of commands, repeated ones included; sent: the same with stop commands;
  /// resumed: number of times that the robot was driven again after a stop; overrides: number of
  /// times that manual commands took over; limited: number of ticks with a value beyond a minimum
  /// or maximum; stops by reason.
  std::vector<Counter> counters() const;

 private:
  enum class State : std::uint8_t { idle, running, stopped, closed };

  // All functions below are called under the lock.
  void enter(State state, TimeNs now);
  /// Stops the robot from every state.
  TimeNs halt(StopReason reason, TimeNs now);
  TimeNs stop_network(StopReason reason, TimeNs now);
  TimeNs drive(std::span<const double> values, TimeNs now);
  TimeNs drive_by_hand(TimeNs now);
  TimeNs repeat(TimeNs now);
  void send_stop(TimeNs now);
  void publish();
  bool still_overridden(TimeNs now);
  std::vector<double> computed_stop(TimeNs now) const;
  std::vector<double> known_stop(TimeNs now) const;
  TimeNs next_due() const;

  mutable std::mutex mutex_;
  CommandGate gate_;
  Limiter limiter_;
  Publish publish_;
  std::vector<StopRule> rules_;
  struct Measurement {
    double position = std::numeric_limits<double>::quiet_NaN();
    TimeNs time = 0;
  };
  std::vector<Measurement> measured_;  ///< per component
  std::vector<double> stop_;           ///< the stop command; see stop_values()
  std::atomic<bool> drives_{false};    ///< state_ is `running`
  State state_ = State::idle;
  std::optional<TimeNs> stopped_since_;  ///< begin of the stop; nullopt if not stopped
  TimeNs stopped_time_ = 0;              ///< of earlier stops
  StopReason reason_ = StopReason::no_value;
  bool driven_ = false;          ///< a command has been sent
  bool may_lack_value_ = false;  ///< see allow_no_value()
  /// Reason why the network does not drive, also while manual commands do.
  std::optional<StopReason> network_stop_ = StopReason::no_value;
  std::optional<StopReason> held_;
  std::vector<double> override_;  ///< the newest manual command
  TimeNs override_timeout_;
  TimeNs override_until_ = 0;
  bool overridden_ = false;
  TimeNs suspended_until_ = std::numeric_limits<TimeNs>::min();  ///< no command is sent before
  std::uint64_t commands_ = 0;
  std::uint64_t resumed_ = 0;
  std::uint64_t overrides_ = 0;
  std::array<std::uint64_t, kStopReasons> stops_{};
};

}  // namespace spikeloop::command
