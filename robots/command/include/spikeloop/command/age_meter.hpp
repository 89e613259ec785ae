// How old the data behind a command are.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "spikeloop/core/time.hpp"

namespace spikeloop::command {

/// Every tick brings a pace value: the monotonic time in seconds at which the newest message that
/// the sensor side used arrived; NaN before the first. The data take `pipeline_ticks` ticks longer
/// than the pace, so a tick's command rests on the pace value of `pipeline_ticks` ticks ago.
class AgeMeter {
 public:
  struct Report {
    std::uint64_t messages = 0;  ///< messages that reached a command
    /// Age at the first tick whose data came from a message: median and 99th percentile (nearest
    /// rank) over the newest 2^20 messages. Ages of all ticks: the largest. NaN without messages.
    double latency_median_ms = std::numeric_limits<double>::quiet_NaN();
    double latency_p99_ms = std::numeric_limits<double>::quiet_NaN();
    double age_max_ms = std::numeric_limits<double>::quiet_NaN();
  };

  explicit AgeMeter(std::size_t pipeline_ticks);

  /// The age of this tick's data; nothing before the first message's have come.
  std::optional<TimeNs> update(double pace_seconds, TimeNs now);
  Report report() const;

 private:
  std::vector<double> delayed_;  ///< ring of pace values
  std::size_t next_ = 0;
  double newest_ = std::numeric_limits<double>::quiet_NaN();
  std::vector<TimeNs> latencies_;  ///< ring once it is full
  std::uint64_t messages_ = 0;
  TimeNs age_max_ = 0;
};

}  // namespace spikeloop::command
