// Times of messages, without the jumps of the clock of the computer that recorded them.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "spikeloop/core/time.hpp"

namespace spikeloop::bag {

/// A clock jumps when it is set, and when a simulation starts again. A jump is a step forward by
/// more than a day, or backward by more than a second within one connection or by more than a day.
/// Files are written in the order of arrival, so that the message after a jump follows the one
/// before.
class RecordedClock {
 public:
  /// Time of the next message in the order of the file, without jumps.
  TimeNs next(std::uint32_t connection, TimeNs time);
  /// Sentence that names the first jump and the number of the others; empty if there are none.
  std::string warning(const std::string& recording) const;
  /// The longest time between two messages that follow each other in the file, without jumps.
  struct Gap {
    TimeNs begin = 0;
    TimeNs end = 0;
  };
  const Gap& longest_gap() const { return gap_; }

 private:
  struct Jump {
    TimeNs from;
    TimeNs to;
    std::uint64_t messages;  ///< before the jump
  };

  std::vector<TimeNs> last_;  ///< of connections, without jumps
  TimeNs newest_ = 0;         ///< of all messages, without jumps
  TimeNs oldest_ = 0;         ///< the same
  TimeNs offset_ = 0;         ///< to add to times of the file
  std::uint64_t messages_ = 0;
  std::optional<Jump> first_;
  std::uint64_t jumps_ = 0;
  Gap gap_;
};

}  // namespace spikeloop::bag
