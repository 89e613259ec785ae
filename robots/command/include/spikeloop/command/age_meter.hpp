// How old the data behind a command are.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "spikeloop/core/time.hpp"

namespace spikeloop::command {

/// Every tick brings the data_stamp value of the data behind its command: the monotonic time in
/// seconds at which the newest message in them arrived; NaN before the first.
class AgeMeter {
 public:
  static constexpr std::size_t kKept = std::size_t{1} << 17;

  struct Report {
    std::uint64_t messages = 0;  ///< messages that reached a command
    /// Age at the first tick whose data came from a message: median and 99th percentile (nearest
    /// rank) over the newest kKept messages. Ages of all ticks: the largest. NaN without messages.
    double latency_median_ms = std::numeric_limits<double>::quiet_NaN();
    double latency_p99_ms = std::numeric_limits<double>::quiet_NaN();
    double age_max_ms = std::numeric_limits<double>::quiet_NaN();
  };

  /// The age of this tick's data; nothing before the first message's have come.
  std::optional<TimeNs> update(double arrived_s, TimeNs now);
  Report report() const;
  /// Messages that have reached a command so far.
  std::uint64_t messages() const { return messages_; }

 private:
  double newest_ = std::numeric_limits<double>::quiet_NaN();
  /// A ring, whole from the beginning: a loop that runs for days neither grows nor copies it.
  std::vector<TimeNs> latencies_ = std::vector<TimeNs>(kKept);
  std::uint64_t messages_ = 0;
  TimeNs age_max_ = 0;
};

}  // namespace spikeloop::command
