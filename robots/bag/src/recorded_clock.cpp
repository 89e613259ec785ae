#include "recorded_clock.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

namespace spikeloop::bag {
namespace {

constexpr TimeNs kDay = 24 * 3600 * kNsPerSecond;
constexpr TimeNs kBackward = kNsPerSecond;
constexpr TimeNs kNone = std::numeric_limits<TimeNs>::min();

/// a + b, limited: a damaged file may have any times.
TimeNs sum(TimeNs a, TimeNs b) {
  TimeNs result = 0;
  return !__builtin_add_overflow(a, b, &result) ? result
         : a > 0                                ? std::numeric_limits<TimeNs>::max()
                                                : kNone;
}

}  // namespace

TimeNs RecordedClock::next(std::uint32_t connection, TimeNs time) {
  if (connection >= last_.size()) {
    last_.resize(connection + 1, kNone);
  }
  TimeNs& last = last_[connection];
  TimeNs result = sum(time, offset_);
  if (messages_ == 0) {
    newest_ = oldest_ = result;
  }
  const TimeNs step = sum(result, -newest_);
  if (step > kDay || sum(oldest_, -kDay) > result ||
      (last != kNone && sum(last, -kBackward) > result)) {
    if (jumps_++ == 0) {
      first_ = {sum(newest_, -offset_), time, messages_};
    }
    offset_ = sum(newest_, -time);
    result = newest_;
  } else if (step > gap_.end - gap_.begin) {
    gap_ = {newest_, result};
  }
  newest_ = std::max(newest_, result);
  oldest_ = std::min(oldest_, result);
  last = std::max(last, result);
  ++messages_;
  return result;
}

std::string RecordedClock::warning(const std::string& recording) const {
  if (!first_) {
    return "";
  }
  return fmt::format(
      "'{}': its clock jumps from {} to {} after {} {}{}; the messages after a jump follow at once",
      recording, format_time(first_->from), format_time(first_->to), first_->messages,
      first_->messages == 1 ? "message" : "messages",
      jumps_ > 1 ? fmt::format(" (the first of {} jumps)", jumps_) : "");
}

}  // namespace spikeloop::bag
