// Limits the values of a command and their rates of change. A pure function of values and times.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "spikeloop/core/time.hpp"

namespace spikeloop::command {

struct Bounds {
  double minimum = -std::numeric_limits<double>::infinity();
  double maximum = std::numeric_limits<double>::infinity();
  double slew = std::numeric_limits<double>::infinity();  ///< maximum change per second
  bool zero_stops = true;  ///< True if 0 stops the component; false for a position
};

/// Limits values and slew rates. Between two calls a component changes by at most its slew rate
/// times the elapsed time.
class Limiter {
 public:
  struct Cut {
    std::size_t component = 0;
    double value = 0;  ///< before it was limited
  };

  /// @param bounds one per component; if fewer, the remaining components have no bounds
  Limiter(std::vector<Bounds> bounds, std::size_t components);

  /// Sets the values of a stop command, from which the next commands slew. NaN: unknown, the next
  /// command is reached at once.
  void restart(std::span<const double> values, TimeNs now);
  /// Limits finite values. The result is valid until the next call.
  /// @param accept_zero True if 0 is accepted in spite of the bounds
  std::span<const double> shape(std::span<const double> values, TimeNs now,
                                bool accept_zero = false);
  /// Number of calls with a value beyond a minimum or maximum.
  std::uint64_t cuts() const { return cuts_; }
  const std::optional<Cut>& first_cut() const { return first_cut_; }

 private:
  std::vector<Bounds> bounds_;
  std::vector<double> values_;  ///< values at `time_`
  TimeNs time_ = 0;
  std::uint64_t cuts_ = 0;
  std::optional<Cut> first_cut_;
};

}  // namespace spikeloop::command
