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
  double slew = std::numeric_limits<double>::infinity();  ///< fastest change per second
  bool zero_stands = true;  ///< True if 0 stops the component; false for a position
};

/// Between any two calls no component moves by more than its slew rate times the time between them.
class Limiter {
 public:
  struct Cut {
    std::size_t component = 0;
    double value = 0;  ///< as it came
  };

  /// @param bounds one per component; fewer: the others have none
  Limiter(std::vector<Bounds> bounds, std::size_t components);

  /// The robot is stopped by `values`, from which the next commands slew. NaN:
  /// unknown, the next command is reached at once.
  void restart(std::span<const double> values, TimeNs now);
  /// Limits finite values. The result is valid until the next call.
  /// @param may_stand 0 is within all bounds: a person may always stop the robot
  std::span<const double> shape(std::span<const double> values, TimeNs now, bool may_stand = false);
  /// Calls in which a value lay beyond a minimum or maximum.
  std::uint64_t cuts() const { return cuts_; }
  const std::optional<Cut>& first_cut() const { return first_cut_; }

 private:
  std::vector<Bounds> bounds_;
  std::vector<double> values_;  ///< at `time_`
  TimeNs time_ = 0;
  std::uint64_t cuts_ = 0;
  std::optional<Cut> first_cut_;
};

}  // namespace spikeloop::command
