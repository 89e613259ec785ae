// When a command leaves. A pure function of values and times, so that every rule is a test.
#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "spikeloop/core/time.hpp"

namespace spikeloop::command {

/// Bounds of the time between two zeros of a stopped robot.
inline constexpr TimeNs kShortestRepetition = 10'000'000;
inline constexpr TimeNs kLongestRepetition = 100'000'000;

/// All times are wall time.
struct GateSettings {
  std::vector<double> deadband;  ///< a component: how far it may move without being sent
  TimeNs min_interval = 0;       ///< two commands are never closer, less `tolerance`
  TimeNs period = 0;             ///< sent again after that time at the latest; 0: only on movement
  /// poll() leaves repetitions that long to the next offer(), which may bring something newer.
  TimeNs grace = 0;
  /// New values may leave that much sooner than `min_interval`. Ticks jitter and come in bursts:
  /// without it one late command would hold back all that follow.
  TimeNs tolerance = 0;
};

/// A command leaves at once when a component has moved by more than its deadband from the last one
/// sent, or has come to exactly zero, but not closer than `min_interval` to it, and again every
/// `period`. A forced command is repeated until the next offer: every `period`, which is then
/// limited to kShortestRepetition to kLongestRepetition, but not closer than `min_interval`.
class CommandGate {
 public:
  explicit CommandGate(GateSettings settings);

  /// Takes the newest command. True: current() leaves now.
  bool offer(std::span<const double> command, TimeNs now);
  /// Between offers: true when a command that was held back, or a repetition, leaves now.
  bool poll(TimeNs now);
  /// When poll() will say true if nothing new is offered.
  TimeNs next_due() const;
  /// Takes a command that leaves now whatever the rules say, and is repeated by poll().
  void force(std::span<const double> command, TimeNs now);
  /// The next command leaves at once.
  void forget();

  std::span<const double> current() const { return current_; }
  /// Commands that have left: of offer(), poll() and force().
  std::uint64_t sent() const { return sent_count_; }

 private:
  bool moved() const;
  TimeNs due() const;
  bool send(TimeNs now);

  GateSettings settings_;
  std::vector<double> current_;
  std::vector<double> last_;
  TimeNs last_time_ = 0;
  bool any_ = false;     ///< current_ holds a command
  bool sent_ = false;    ///< last_ holds a command
  bool forced_ = false;  ///< force() has set current_
  std::uint64_t sent_count_ = 0;
};

}  // namespace spikeloop::command
