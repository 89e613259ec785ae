#include "spikeloop/process/transfer.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace spikeloop::music {

TimeNs guarded_stamp(TimeNs stamp, const Interval& interval) {
  return std::max(stamp, std::min(interval.begin + kStampGuard, interval.end));
}

void SpikeInbox::add(double seconds, int id) {
  constexpr double kLongest = 4.6e9;  // half of what TimeNs holds, so that delays can be added
  if (id < 0 || static_cast<std::uint32_t>(id) >= width_) {
    ++outside_port_;
  } else if (!(std::abs(seconds) < kLongest)) {
    ++without_time_;
  } else {
    spikes_.push_back(make_spike(std::llround(seconds * 1e9), id));
  }
}

std::span<const Spike> SpikeDelay::pass(std::span<const Spike> spikes, const Interval& interval) {
  for (const Spike& spike : spikes) {
    waiting_.push_back(make_spike(spike.time_ns + delay_, spike.channel));
  }
  due_.clear();
  std::erase_if(waiting_, [&](const Spike& spike) {
    const bool due = spike.time_ns <= interval.end;
    if (due) {
      due_.push_back(spike);
    }
    return due;
  });
  return due_;
}

bool SignalBlock::update(std::span<const double> values) {
  if (std::memcmp(values.data(), values_.data(), values_.size() * sizeof(double)) == 0) {
    return false;
  }
  std::copy(values.begin(), values.end(), values_.begin());
  valid_ = !std::all_of(values.begin(), values.end(), [](double value) { return value != value; });
  ++count_;
  return true;
}

}  // namespace spikeloop::music
