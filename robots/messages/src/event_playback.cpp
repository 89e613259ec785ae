#include "spikeloop/messages/event_playback.hpp"

#include <algorithm>

namespace spikeloop::messages {
namespace {

bool earlier(const Spike& a, const Spike& b) {
  return a.time_ns < b.time_ns;
}

}  // namespace

void SensorClock::take(TimeNs newest, TimeNs now) {
  const bool jumped = set_ && (newest < newest_ || simulated(newest) > now + kFarthest);
  if (!set_ || jumped) {
    offset_ = now - newest;
  }
  jumps_ += jumped ? 1 : 0;
  newest_ = newest;
  set_ = true;
}

void EventPlayback::add(const EventMessage& message, const Interval& interval) {
  if (!message.newest) {
    return;
  }
  clock_.take(*message.newest, interval.begin);
  for (const Spike& event : message.events) {
    TimeNs time = clock_.simulated(event.time_ns) + latency_;
    if (time <= interval.begin) {
      ++late_;
      worst_lateness_ = std::max(worst_lateness_, interval.begin + 1 - time);
      time = interval.begin + 1;
    }
    queue_.push_back(make_spike(time, event.channel));
  }
}

/// Sensors stamp in order, nearly always: then there is nothing to do.
void EventPlayback::sort_behind(std::size_t begin) {
  const auto added = queue_.begin() + static_cast<std::ptrdiff_t>(begin);
  const auto waiting = queue_.begin() + static_cast<std::ptrdiff_t>(sent_);
  if (!std::is_sorted(added, queue_.end(), earlier)) {
    std::stable_sort(added, queue_.end(), earlier);
  }
  if (added != waiting && added != queue_.end() && earlier(*added, *(added - 1))) {
    std::inplace_merge(waiting, added, queue_.end(), earlier);
  }
}

std::span<const Spike> EventPlayback::step(std::span<const EventMessage> messages,
                                           const Interval& interval) {
  if (2 * sent_ >= queue_.size()) {  // seldom, so that its cost does not count
    queue_.erase(queue_.begin(), queue_.begin() + static_cast<std::ptrdiff_t>(sent_));
    sent_ = 0;
  }
  const std::size_t before = queue_.size();
  for (const EventMessage& message : messages) {
    add(message, interval);
  }
  sort_behind(before);
  const auto first = queue_.begin() + static_cast<std::ptrdiff_t>(sent_);
  const auto last = std::upper_bound(first, queue_.end(), make_spike(interval.end, 0), earlier);
  const std::span<const Spike> due(first, last);
  sent_ += due.size();
  return due;
}

}  // namespace spikeloop::messages
