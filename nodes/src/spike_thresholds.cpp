#include "spike_thresholds.hpp"

#include <algorithm>

namespace spikeloop {

SpikeThresholds::SpikeThresholds(const NodeSetup& setup, bool poisson, SpikeSchedule& schedule)
    : stream_(setup.noise_seed(), setup.name),
      first_(schedule.first()),
      draws_(poisson ? schedule.channels() : 0, 0) {
  for (std::uint32_t c = 0; c < draws_.size(); ++c) {
    double threshold = 0;
    (*this)({&c, 1}, {&threshold, 1});
    schedule.set_first_threshold(c, threshold);
  }
}

void SpikeThresholds::operator()(std::span<const std::uint32_t> channels, std::span<double> next) {
  if (draws_.empty()) {
    std::ranges::fill(next, 1.0);
    return;
  }
  indices_.resize(channels.size());
  for (std::size_t i = 0; i < channels.size(); ++i) {
    indices_[i] = draws_[channels[i]]++;
  }
  stream_.uniform(first_, channels, indices_, next);
  negative_logarithms(next);
}

}  // namespace spikeloop
