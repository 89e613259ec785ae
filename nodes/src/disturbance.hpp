// When a disturbance acts: keys `from` and `to`.
#pragma once

#include <vector>

#include "parameter_checks.hpp"
#include "spikeloop/core/parameters.hpp"
#include "spikeloop/core/time.hpp"

namespace spikeloop {

class Disturbance {
 public:
  explicit Disturbance(const Parameters& parameters)
      : from_(from_seconds(parameters.number("from"))), to_(from_seconds(parameters.number("to"))) {
    require_at_most(parameters, "from", "to");
  }
  /// Whether the time is in (from, to].
  bool contains(TimeNs time) const { return time > from_ && time <= to_; }

 private:
  TimeNs from_;
  TimeNs to_;
};

inline void append_disturbance_period(std::vector<ParameterDescription>& parameters) {
  parameters.push_back(number_parameter("from", "s", "0", 0, 1e6, "Begin of the disturbance"));
  parameters.push_back(number_parameter("to", "s", "1e6", 0, 1e6, "End of the disturbance"));
}

}  // namespace spikeloop
