// From numbers to commands that leave: limits, the gate, and every reason for which a robot is
// stopped. Whatever carries the commands, ROS 1 or ROS 2, is a function.
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

#include "spikeloop/command/command_gate.hpp"
#include "spikeloop/command/limiter.hpp"
#include "spikeloop/command/stop_reason.hpp"
#include "spikeloop/config/mapping_file.hpp"
#include "spikeloop/core/node.hpp"

namespace spikeloop::command {

inline constexpr TimeNs kContinuedPause = 1'500'000'000;

struct ChannelSettings {
  GateSettings gate;
  std::vector<Bounds> bounds{};   ///< one a component; fewer: the others have none
  TimeNs override_timeout = 0;    ///< validity of a manual command
  std::vector<StopRule> stops{};  ///< per component; fewer: the others are 0 at a stop
};

/// Maximum age of a measured position. If it is older, a stop holds the last command.
inline constexpr TimeNs kMeasuredAge = 500'000'000;

/// Safe to use from the loop, the watch and those who bring messages at once. Publishing happens
/// under its lock, so it must not block.
///
/// Who wins: the end of the run, a continue, the emergency stop, a manual command, a reason of the
/// loop or its silence, the network's command.
class CommandChannel {
 public:
  using Publish = std::function<void(std::span<const double>)>;

  CommandChannel(const ChannelSettings& settings, Publish publish);

  /// A tick's command. Returns when poll() should be called if nothing else comes.
  /// A command with a value that is not finite is never sent: it stops the robot.
  TimeNs command(std::span<const double> values, TimeNs now);

  /// Sends the stop command at once, past all rules, and repeats it (see CommandGate) until the
  /// robot is driven again: a message can be lost, and a robot can connect later. After `continued`
  /// no command is sent for kContinuedPause: mpirun sends SIGCONT when a program has died, and
  /// SIGTERM 1 s later. After `terminated` and `ended` nothing more leaves at all. Before the first
  /// command only a request from outside the loop sends anything. While manual commands hold, the
  /// loop's reasons and `silent` wait for their end.
  TimeNs stop(StopReason reason, TimeNs now);

  /// As long as there is a reason (of the emergency stop), nothing but zeros leaves: at once, and
  /// repeated.
  void hold(std::optional<StopReason> reason, TimeNs now);

  /// A command by hand: leaves in place of the network's, as far as the bounds let it, until none
  /// has come for the timeout. One that is not finite is a zero.
  void override_with(std::span<const double> values, TimeNs now);

  /// Newly measured positions of the components that a stop holds; NaN: not measured now.
  void measure(std::span<const double> positions, TimeNs now);
  /// The command that stops the robot: that of the stop that lasts, else of one at `now`. Each stop
  /// fixes its values once, so that a joint that yields is not followed. NaN: no position is known.
  std::vector<double> stop_values(TimeNs now) const;
  /// True while the commands of the network or manual ones are sent. May be called by `publish`.
  bool drives() const { return drives_.load(); }

  /// A robot hears the commands from now on: the next one leaves in any case, and slews from zero.
  void begin_anew(TimeNs now);

  /// Nodes before the command begin anew: when it has no value then, a zero leaves, which is no
  /// stop: as at the begin of a run.
  void allow_no_value();

  /// Sends what is due between ticks; returns when to call again.
  TimeNs poll(TimeNs now);
  /// Sends the zero of a stopped robot again, due or not: for a caller whose clock may stand still.
  void repeat_stop(TimeNs now);

  struct Standing {
    /// Why the robot stands; nothing while it is driven, and before the first command.
    std::optional<StopReason> stopped;
    bool overridden = false;  ///< manual commands hold
    bool driven = false;      ///< there has been a command of the network, or one by hand
  };
  Standing standing() const;
  std::optional<StopReason> stopped_by() const { return standing().stopped; }
  bool overridden() const { return standing().overridden; }
  enum class NetworkCommand : std::uint8_t {
    unused,     ///< the robot is stopped, or driven manually
    held_back,  ///< a change waits for its least interval
    sent        ///< the robot has the newest command, apart from changes within the deadband
  };
  NetworkCommand network_command() const;
  /// How long the robot stood while it had a reason to, until it was last driven or the run ended.
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
  void send_stop(TimeNs now);
  void publish_stop();
  std::vector<double> computed_stop(TimeNs now) const;
  TimeNs drive(std::span<const double> values, TimeNs now);
  TimeNs stop_network(StopReason reason, TimeNs now);
  TimeNs repeat_stop_command(TimeNs now);
  bool still_overridden(TimeNs now);
  TimeNs drive_by_hand(TimeNs now);
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
  bool driven_ = false;          ///< a command has left
  bool may_lack_value_ = false;  ///< see allow_no_value
  /// Why the network does not drive, whoever else does.
  std::optional<StopReason> network_stop_ = StopReason::no_value;
  std::optional<StopReason> held_;
  std::vector<double> override_;  ///< the newest manual command
  bool override_stops_ = false;   ///< it is not a number
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
