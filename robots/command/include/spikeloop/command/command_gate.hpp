// Decides when a command is sent. A pure function of values and times.
#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "spikeloop/core/time.hpp"

namespace spikeloop::command {

/// Bounds of the time between two stop commands of a stopped robot.
inline constexpr TimeNs kShortestRepetition = 10'000'000;
inline constexpr TimeNs kLongestRepetition = 100'000'000;

/// All times are those of the clock of the command, see CommandClock.
struct GateSettings {
  std::vector<double> deadband;  ///< per component: change that is not sent
  TimeNs min_interval = 0;       ///< minimum time between two changes, less `tolerance`
  TimeNs period = 0;             ///< time after which a command is repeated; 0: never
  /// Additional time before the first repetition of a change: a sensor with the period of the
  /// repetitions may be late by its driver's jitter.
  TimeNs grace = 0;
  /// Additional time before poll() repeats a command, so that the next offer() can send a newer
  /// command instead.
  TimeNs poll_grace = 0;
  /// A change may be sent by this time sooner than `min_interval`. Ticks jitter and come in bursts:
  /// without a tolerance, one late command would delay all following ones.
  TimeNs tolerance = 0;
};

/// A change is a component that differs by more than its deadband from the command sent last, or
/// has become exactly zero. A change is sent at once, but not sooner than `min_interval` after the
/// previous change: a repetition never delays a change. Without a change the command is repeated
/// `period` + `grace` after the last change, then every `period`. A forced command is repeated
/// until the next offer: every `period`, which is then limited to kShortestRepetition to
/// kLongestRepetition, but not sooner than `min_interval`.
class CommandGate {
 public:
  explicit CommandGate(GateSettings settings);

  /// Takes the newest command. Returns true if current() is to be sent now.
  bool offer(std::span<const double> command, TimeNs now);
  /// Called between offers. Returns true if a delayed change or a repetition is due.
  bool poll(TimeNs now);
  /// Earliest time at which poll() returns true without a new offer.
  TimeNs next_due() const;
  /// Takes a command that the caller sends now in any case, and that poll() repeats.
  void force(std::span<const double> command, TimeNs now);
  /// Forgets the last command, so that the next offer is sent at once.
  void forget();
  /// True while a change waits for `min_interval`.
  bool holds_back() const { return any_ && sent_ && !forced_ && moved(); }

  std::span<const double> current() const { return current_; }
  /// The command that was sent last, forced ones included.
  std::span<const double> last() const { return last_; }
  /// Number of commands sent: by offer(), poll() and force().
  std::uint64_t sent() const { return sent_count_; }

 private:
  bool moved() const;
  /// @param more_grace additional time before a repetition
  TimeNs due(TimeNs more_grace) const;
  bool send(TimeNs now);

  GateSettings settings_;
  std::vector<double> current_;
  std::vector<double> last_;
  TimeNs last_time_ = 0;    ///< time of the newest command
  TimeNs last_change_ = 0;  ///< time of the newest change
  bool any_ = false;        ///< current_ holds a command
  bool sent_ = false;       ///< last_ holds a command
  bool forced_ = false;     ///< force() has set current_
  std::uint64_t sent_count_ = 0;
};

}  // namespace spikeloop::command
