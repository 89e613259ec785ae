#include "spike_schedule.hpp"

namespace spikeloop {

SpikeSchedule::SpikeSchedule(std::uint32_t channels)
    : rate_(channels, 0.0),
      next_(channels, kNever),
      rest_(channels, 1.0),
      earliest_((std::size_t{channels} + kBlock - 1) / kBlock, kNever) {}

void SpikeSchedule::change_rate(std::uint32_t channel, double rate, TimeNs now) {
  double left = rest_[channel];
  if (rate_[channel] > 0.0) {
    const double wait = static_cast<double>(next_[channel] - now) + rest_[channel];
    left = std::max(0.0, wait * rate_[channel] * 1e-9);
  }
  rate_[channel] = rate;
  if (rate == 0.0) {
    next_[channel] = kNever;
    rest_[channel] = left;
  } else {
    set_due(channel, now, left * 1e9 / rate);
  }
}

}  // namespace spikeloop
