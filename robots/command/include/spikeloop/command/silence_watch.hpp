// Finds the source that has been silent for too long. A pure function of times.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "spikeloop/core/time.hpp"

namespace spikeloop::command {

class SilenceWatch {
 public:
  /// @param timeouts one per source; 0: unlimited
  explicit SilenceWatch(const std::vector<TimeNs>& timeouts)
      : timeouts_(timeouts), arrivals_(timeouts.size()) {}

  /// Sets the arrival time of the newest message of a source.
  void set_arrival(std::size_t source, TimeNs at) { arrivals_[source] = at; }
  /// Index of the first source whose newest message is older than its timeout, or that has sent no
  /// message. nullopt: no source is silent
  std::optional<std::size_t> silent(TimeNs now) const {
    for (std::size_t i = 0; i < timeouts_.size(); ++i) {
      if (timeouts_[i] != 0 && (!arrivals_[i] || now - *arrivals_[i] > timeouts_[i])) {
        return i;
      }
    }
    return std::nullopt;
  }

 private:
  std::vector<TimeNs> timeouts_;
  std::vector<std::optional<TimeNs>> arrivals_;
};

}  // namespace spikeloop::command
