#include "nef_population.hpp"

#include <algorithm>

#include "due_blocks.hpp"

namespace spikeloop {

NefPopulation::NefPopulation(const NefModel& model, std::uint32_t neurons, std::uint32_t dimensions)
    : model_(model),
      grid_(static_cast<TimeNs>(model.resolution)),
      dimensions_(dimensions),
      fast_((std::size_t{neurons} + kBlock - 1) / kBlock, NefFast{}),
      slow_(fast_.size(), NefSlow{}),
      earliest_(fast_.size(), static_cast<float>(kNeverDue)),
      directions_(fast_.size() * kBlock * dimensions, 0.0F),
      due_(fast_.size()),
      firing_{.model = &model_, .fast = fast_.data(), .earliest = earliest_.data()} {}

void NefPopulation::set_neuron(std::uint32_t n, double gain, double bias, double potential,
                               std::span<const double> direction) {
  const std::size_t block = n / kBlock;
  const std::size_t lane = n % kBlock;
  slow_[block].gain[lane] = static_cast<float>(gain);
  slow_[block].bias[lane] = static_cast<float>(bias);
  fast_[block].state[lane] = potential;
  fast_[block].target[lane] = potential;
  float* const first = &directions_[block * kBlock * dimensions_ + lane];
  for (std::size_t k = 0; k < dimensions_; ++k) {
    first[k * kBlock] = static_cast<float>(direction[k]);
  }
}

void NefPopulation::set_input(TimeNs now, std::span<const double> x) {
  input_.assign(x.begin(), x.end());
  has_input_ = true;
  change(now);
}

void NefPopulation::rest(TimeNs now) {
  has_input_ = false;
  change(now);
}

void NefPopulation::change(TimeNs now) {
  const auto passed = static_cast<double>(now - since_);
  since_ = now;
  change_targets({.model = &model_,
                  .fast = fast_.data(),
                  .slow = slow_.data(),
                  .earliest = earliest_.data(),
                  .block_count = fast_.size(),
                  .directions = has_input_ ? directions_.data() : nullptr,
                  .input = input_.data(),
                  .dimensions = dimensions_,
                  .passed = passed,
                  .since_grid = static_cast<double>(since_grid()),
                  .committed = &committed_});
  committed_at_ = now + grid_ - since_grid();
}

void NefPopulation::take_committed(TimeNs end, std::uint32_t first_channel,
                                   std::vector<Spike>& spikes) {
  if (committed_.empty() || committed_at_ > end) {
    return;
  }
  for (const std::uint32_t neuron : committed_) {
    spikes.push_back(make_spike(committed_at_, static_cast<std::int32_t>(first_channel + neuron)));
  }
  committed_.clear();
}

void NefPopulation::take_fired(std::uint32_t first_channel, std::vector<Spike>& spikes) const {
  for (std::size_t i = 0; i < firing_.count; ++i) {
    spikes.push_back(make_spike(since_ + static_cast<TimeNs>(firing_.stamps[i]),
                                static_cast<std::int32_t>(first_channel + firing_.neurons[i])));
  }
}

void NefPopulation::advance(TimeNs end, std::uint32_t first_channel, std::vector<Spike>& spikes) {
  while (end - since_ > kLongest) {
    const TimeNs now = since_ + kLongest;
    fire(now, first_channel, spikes);
    change(now);
  }
  fire(end, first_channel, spikes);
}

void NefPopulation::fire(TimeNs end, std::uint32_t first_channel, std::vector<Spike>& spikes) {
  take_committed(end, first_channel, spikes);
  firing_.since_grid = static_cast<double>(since_grid());
  firing_.limit = static_cast<double>(end - since_);
  const std::size_t count =
      find_due(earliest_.data(), earliest_.size(), firing_.limit, due_.data());
  for (std::size_t i = 0; i < count; i += kMostBlocks) {
    std::span<std::uint32_t> blocks(&due_[i], std::min(kMostBlocks, count - i));
    while (!blocks.empty()) {
      blocks = blocks.first(fire_once(firing_, blocks));
      take_fired(first_channel, spikes);
    }
  }
}

}  // namespace spikeloop
