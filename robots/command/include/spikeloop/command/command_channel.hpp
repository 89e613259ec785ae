// Sends commands after limits and gate, and stops the robot for every reason. A function carries
// the commands to ROS 1 or ROS 2.
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
/// Priority: the end of the run, a continue, the emergency stop, a manual command, a reason of the
/// loop or its silence, the command of the network.
class CommandChannel {
 public:
  using Publish = std::function<void(std::span<const double>)>;

  CommandChannel(const CommandSettings& settings, Publish publish);

  /// Takes the command of a tick. Returns when poll() should be called if nothing else comes.
  /// A value that is not finite stops the robot.
  TimeNs command(std::span<const double> values, TimeNs now);

  /// Sends the stop command at once, past all rules, and repeats it (see CommandGate) until the
  /// robot is driven again: a message can be lost, and a robot can connect later. After `continued`
  /// no command is sent for kContinuedPause: mpirun sends SIGCONT when a program has died, and
  /// SIGTERM 1 s later. After `terminated` and `ended` nothing more leaves at all. Before the first
  /// command only a request from outside the loop sends anything. While manual commands hold, the
  /// loop's reasons and `silent` wait for their end.
  TimeNs stop(StopReason reason, TimeNs now);

  /// Stops the robot as long as the emergency stop has a reason.
  void hold(std::optional<StopReason> reason, TimeNs now);

  /// Sends a manual command within the bounds. It replaces the network's until the timeout. One
  /// that is not finite stops the robot.
  void override_with(std::span<const double> values, TimeNs now);

  /// Newly measured positions of the components that a stop holds; NaN: not measured now.
  void measure(std::span<const double> positions, TimeNs now);
  /// The command that stops the robot: that of the present stop, else of a stop at `now`. Each stop
  /// fixes its values once, so that a joint that yields is not followed. NaN: no position is known.
  std::vector<double> stop_values(TimeNs now) const;
  /// True while the commands of the network or manual ones are sent. May be called by `publish`.
  bool drives() const { return drives_.load(); }

  /// A robot has subscribed: the next command is sent in any case, and slews from the stop command.
  void begin_anew(TimeNs now);
  /// The nodes before the command are reset: a command without a value is then no stop, as at the
  /// start of a run.
  void allow_no_value();

  /// Sends what is due between ticks; returns when to call again.
  TimeNs poll(TimeNs now);
  /// Sends the command of a stopped robot again, due or not: simulated time may stand still.
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
    held_back,  ///< a change waits for its least interval
    sent        ///< the robot has the newest command, apart from changes within the deadband
  };
  NetworkCommand network_command() const;
  /// Total time of all stops that have ended.
  TimeNs stood_for() const;
  /// The first value that the bounds have cut.
  std::optional<Limiter::Cut> first_cut() const;

  /// commands, repeated ones included; sent: these and the zeros of stops; resumed; overrides:
  /// times that manual commands took over; limited: ticks whose command the bounds have cut; stops
  /// by reason.
  std::vector<Counter> counters() const;

 private:
  enum class State : std::uint8_t { idle, running, stopped, closed };

  // All below are called under the lock.
  void enter(State state, TimeNs now);
  /// Stops the robot, whatever it did before.
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
  std::optional<TimeNs> stands_since_;  ///< begin of the stop. nullopt if the robot may be driven
  TimeNs stood_for_ = 0;                ///< before that
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
  TimeNs suspended_until_ = std::numeric_limits<TimeNs>::min();  ///< no command before
  std::uint64_t commands_ = 0;
  std::uint64_t resumed_ = 0;
  std::uint64_t overrides_ = 0;
  std::array<std::uint64_t, kStopReasons> stops_{};
};

}  // namespace spikeloop::command
