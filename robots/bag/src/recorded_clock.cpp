#include "recorded_clock.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

namespace spikeloop::bag {
namespace {

constexpr TimeNs kForward = 24 * 3600 * kNsPerSecond;
constexpr TimeNs kForwardFromZero = 60 * kNsPerSecond;
constexpr TimeNs kBackward = kNsPerSecond;
constexpr TimeNs kNone = std::numeric_limits<TimeNs>::min();

}  // namespace

TimeNs RecordedClock::next(std::uint32_t connection, TimeNs time) {
  if (connection >= last_.size()) {
    last_.resize(connection + 1, kNone);
  }
  TimeNs& last = last_[connection];
  TimeNs result = time + offset_;
  const TimeNs longest = newest_ == offset_ ? kForwardFromZero : kForward;
  const bool jumps =
      messages_ > 0 && (result - newest_ > longest || (last != kNone && last - result > kBackward));
  if (jumps) {
    if (jumps_++ == 0) {
      first_ = {newest_ - offset_, time, messages_};
    }
    offset_ += newest_ - result;
    result = newest_;
  }
  if (messages_ > 0 && result - newest_ > gap_.end - gap_.begin) {
    gap_ = {newest_, result};
  }
  newest_ = messages_ == 0 ? result : std::max(newest_, result);
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
      jumps_ > 1 ? fmt::format(", and {} more times", jumps_ - 1) : "");
}

}  // namespace spikeloop::bag
