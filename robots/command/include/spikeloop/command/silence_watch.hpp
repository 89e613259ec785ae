// Finds the source that has been silent for too long. A pure function of times.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "spikeloop/core/time.hpp"

namespace spikeloop::command {

class SilenceWatch {
 public:
  /// @param timeouts one per source; 0: it may be silent
  explicit SilenceWatch(const std::vector<TimeNs>& timeouts)
      : timeouts_(timeouts), heard_(timeouts.size()) {}

  /// Sets the arrival time of the newest message of a source.
  void heard(std::size_t source, TimeNs at) { heard_[source] = at; }
  /// The first source that has been silent for longer than its timeout, or was never heard.
  std::optional<std::size_t> silent(TimeNs now) const {
    for (std::size_t i = 0; i < timeouts_.size(); ++i) {
      if (timeouts_[i] != 0 && (!heard_[i] || now - *heard_[i] > timeouts_[i])) {
        return i;
      }
    }
    return std::nullopt;
  }

 private:
  std::vector<TimeNs> timeouts_;
  std::vector<std::optional<TimeNs>> heard_;
};

}  // namespace spikeloop::command
