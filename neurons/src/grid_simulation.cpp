#include <algorithm>

#include "group.hpp"
#include "simulation.hpp"

namespace spikeloop::neurons {

namespace {

// The step in which a time lies: times are rounded up to the grid. For a negative time, too.
std::int64_t step_of(TimeNs time, TimeNs resolution) {
  return time / resolution + (time % resolution > 0 ? 1 : 0);
}

class GridSimulation final : public Simulation {
 public:
  explicit GridSimulation(const NetworkFile& network)
      : network_(network), channels_(network), outgoing_(outgoing(network)) {
    std::vector<TimeNs> longest(network.populations.size(), 0);
    for (const NetworkProjection& projection : network.projections) {
      longest[projection.to] = std::max(longest[projection.to], projection.delay);
    }
    for (std::size_t i = 0; i < network.populations.size(); ++i) {
      groups_.push_back(
          make_group(network.populations[i], network.resolution, longest[i] / network.resolution));
    }
  }

  // Within a step: first what comes from outside, by (time, channel), then the populations in the
  // file's order. Every delay is at least one step, so this order shows in sums of weights only,
  // and as it does not know the interval the result does not depend on the tick.
  void advance(Interval interval, std::span<const Spike> input,
               std::vector<Spike>& output) override {
    const std::int64_t last = interval.end / network_.resolution;
    std::size_t next = 0;
    for (std::int64_t step = interval.begin / network_.resolution + 1; step <= last; ++step) {
      for (; next < input.size(); ++next) {
        const std::int64_t arrival = step_of(input[next].time_ns, network_.resolution);
        if (arrival > step) {
          break;
        }
        const ChannelMap::Member member = channels_.input(input[next].channel);
        send(member.population, member.index, arrival, step);
      }
      for (std::size_t i = 0; i < groups_.size(); ++i) {
        update(i, step, output);
      }
    }
  }

 private:
  void update(std::size_t population, std::int64_t step, std::vector<Spike>& output) {
    if (!groups_[population]) {
      return;
    }
    fired_.clear();
    groups_[population]->update(step, fired_);
    const std::int32_t base = channels_.output_base(population);
    for (const std::uint32_t index : fired_) {
      send(population, index, step, step + 1);
      if (base >= 0) {
        output.push_back(
            make_spike(step * network_.resolution, base + static_cast<std::int32_t>(index)));
      }
    }
  }

  // A spike of `step` acts its delay later, but not before step `earliest`.
  void send(std::size_t population, std::uint32_t index, std::int64_t step, std::int64_t earliest) {
    for (const NetworkProjection* projection : outgoing_[population]) {
      const std::int64_t arrival = step + projection->delay / network_.resolution;
      groups_[projection->to]->receive(std::max(arrival, earliest), targets(*projection, index),
                                       weights(*projection, index));
    }
  }

  const NetworkFile& network_;
  const ChannelMap channels_;
  const std::vector<std::vector<const NetworkProjection*>> outgoing_;
  std::vector<std::unique_ptr<Group>> groups_;  // none for an input
  std::vector<std::uint32_t> fired_;
};

}  // namespace

std::unique_ptr<Simulation> make_grid_simulation(const NetworkFile& network) {
  return std::make_unique<GridSimulation>(network);
}

}  // namespace spikeloop::neurons
