#include "spike_schedule.hpp"

namespace spikeloop {

SpikeSchedule::SpikeSchedule(const Share& share, std::uint32_t channels)
    : first_(share.begin(channels)),
      channels_(share.count(channels)),
      blocks_((std::size_t{channels_} + kBlock - 1) / kBlock),
      earliest_(blocks_.size(), static_cast<float>(kNeverDue)),
      due_(blocks_.size()) {
  for (ScheduleBlock& block : blocks_) {
    std::ranges::fill(block.rate, 0.0);
    std::ranges::fill(block.state, kSpike);
  }
}

ScheduleChange SpikeSchedule::change_at(double passed) {
  return {.blocks = blocks_.data(),
          .earliest = earliest_.data(),
          .channels = channels_,
          .passed = passed,
          .slowest = kSlowest,
          .highest = kFastest};
}

/// Counts times from another zero, that much later.
void SpikeSchedule::shift(TimeNs passed) {
  change_rates(change_at(static_cast<double>(passed)));
  since_ += passed;
}

/// The exact time is kept, so that rounding to nanoseconds never adds up. Two spikes of a channel
/// are at least a nanosecond apart.
void SpikeSchedule::restart() {
  for (std::size_t i = 0; i < firing_.count; ++i) {
    const std::uint32_t channel = firing_.channels[i];
    const double rate = blocks_[channel / kBlock].rate[channel % kBlock];
    double& state = state_of(channel);
    const double wait = next_[i] * kSpike / rate;
    const double magic = schedule_rounding(wait);
    const double next = round_by(state, magic) + round_by(wait, magic);
    state = std::max(next, firing_.stamps[i] + 0.5);
  }
}

void SpikeSchedule::emit(const SpikeOutput& output) {
  emitted_.resize(firing_.count);
  for (std::size_t i = 0; i < firing_.count; ++i) {
    emitted_[i] = make_spike(since_ + static_cast<TimeNs>(firing_.stamps[i]),
                             static_cast<std::int32_t>(first_ + firing_.channels[i]));
  }
  output.emit(emitted_);
}

}  // namespace spikeloop
