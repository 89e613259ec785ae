// Measures the age of the data behind a command.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <vector>

#include "spikeloop/core/time.hpp"

namespace spikeloop::command {

/// Every tick passes the data_stamp of the data behind its command: the monotonic time in seconds
/// at which the newest message in them arrived; NaN before the first message.
class AgeMeter {
 public:
  static constexpr std::size_t kKept = std::size_t{1} << 17;

  struct Report {
    std::uint64_t messages = 0;  ///< messages whose command was sent
    /// Time from the arrival of a message to the sending of its command: median and 99th
    /// percentile (nearest rank) over the newest kKept messages. Ages of all ticks: the largest.
    /// NaN without messages.
    double latency_median_ms = std::numeric_limits<double>::quiet_NaN();
    double latency_p99_ms = std::numeric_limits<double>::quiet_NaN();
    double age_max_ms = std::numeric_limits<double>::quiet_NaN();
  };

  /// Returns the age of this tick's data; nullopt until a message has arrived. The latency of a new
  /// message is measured by settle().
  std::optional<TimeNs> update(double arrived_s, TimeNs now);
  /// Records the latencies of the waiting messages. Their commands were sent at `sent`, or need not
  /// be sent because they do not change. The latency of a message whose data were computed after
  /// `sent` ends at the tick of these data.
  /// @param take called with each latency; may be empty
  void settle(TimeNs sent, const std::function<void(TimeNs latency)>& take = {});
  /// Discards the waiting messages: no command is sent for them, because the robot is stopped or
  /// driven manually.
  void drop() { waiting_.clear(); }
  Report report() const;

 private:
  struct Message {
    TimeNs arrived = 0;
    TimeNs ticked = 0;  ///< time of the first tick with its data
  };

  double newest_ = std::numeric_limits<double>::quiet_NaN();
  /// Ring buffer of fixed size, so that a loop that runs for days allocates no memory.
  std::vector<TimeNs> latencies_ = std::vector<TimeNs>(kKept);
  std::vector<Message> waiting_;
  std::uint64_t messages_ = 0;
  TimeNs age_max_ = 0;
};

}  // namespace spikeloop::command
