// From numbers to commands that leave: the gate, and every reason for which a robot is stopped.
// Whatever carries the commands, ROS 1 or ROS 2, is a function.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <limits>
#include <mutex>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "spikeloop/command/command_gate.hpp"
#include "spikeloop/core/node.hpp"

namespace spikeloop::command {

enum class StopReason : std::uint8_t {
  no_value,    ///< the input has lost its value
  not_finite,  ///< NaN or infinity among the command's values
  stale,       ///< the data behind the command are too old
  silent,      ///< the loop has not ticked for too long
  continued,   ///< SIGCONT: mpirun has seen a program die, or somebody had stopped us
  terminated,  ///< SIGTERM, SIGINT, or an error
  ended        ///< the run is over
};
inline constexpr std::size_t kStopReasons = 7;

inline constexpr TimeNs kContinuedPause = 1'500'000'000;

/// "data_too_old", ...: the name in counters.
std::string_view stop_reason_name(StopReason reason);

/// Safe to use from the loop and from the watch at once. Publishing happens under its lock, so it
/// must not block.
class CommandChannel {
 public:
  using Publish = std::function<void(std::span<const double>)>;

  CommandChannel(const GateSettings& settings, Publish publish);

  /// A tick's command. Returns when poll() should be called if nothing else comes.
  /// A command with a value that is not finite is never sent: it stops the robot.
  TimeNs command(std::span<const double> values, TimeNs now);

  /// Sends a zero command at once, past all rules. After `no_value`, `not_finite` and `stale`,
  /// which the loop says again every tick, zeros are repeated at the command's period; after
  /// `silent` nothing more leaves until the next tick's command, after `continued` not for another
  /// kContinuedPause: mpirun sends SIGCONT when a program has died, and SIGTERM 1 s later. After
  /// `terminated` and `ended` nothing more leaves at all. Before the first command only a request
  /// from outside the loop sends anything.
  TimeNs stop(StopReason reason, TimeNs now);

  /// Sends what is due between ticks; returns when to call again.
  TimeNs poll(TimeNs now);

  /// Why the robot stands; nothing while it is driven, and before the first command.
  std::optional<StopReason> stopped_by() const;

  /// commands, repeated ones included; stops by reason; resumed.
  std::vector<Counter> counters() const;

 private:
  void send_zero(TimeNs now);

  mutable std::mutex mutex_;
  CommandGate gate_;
  Publish publish_;
  std::vector<double> zero_;
  enum class State : std::uint8_t { idle, running, stopped, suspended, closed };
  State state_ = State::idle;
  StopReason reason_ = StopReason::no_value;
  TimeNs suspended_until_ = std::numeric_limits<TimeNs>::min();  ///< no command before
  std::uint64_t commands_ = 0;
  std::uint64_t resumed_ = 0;
  std::array<std::uint64_t, kStopReasons> stops_{};
};

}  // namespace spikeloop::command
