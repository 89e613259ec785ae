#include <algorithm>
#include <queue>
#include <tuple>

#include "simulation.hpp"

namespace spikeloop::neurons {

namespace {

// Repeaters alone, at exact times: a queue of spikes on their way.
class OffgridSimulation final : public Simulation {
 public:
  explicit OffgridSimulation(const NetworkFile& network)
      : channels_(network), outgoing_(outgoing(network)) {}

  void advance(Interval interval, std::span<const Spike> input,
               std::vector<Spike>& output) override {
    for (const Spike& spike : input) {
      const ChannelMap::Member member = channels_.input(spike.channel);
      send(member.population, member.index, spike.time_ns, interval.begin + 1);
    }
    while (!queue_.empty() && queue_.top().time <= interval.end) {
      const Arrival now = queue_.top();
      queue_.pop();
      send(now.population, now.index, now.time, now.time + 1);
      if (const std::int32_t base = channels_.output_base(now.population); base >= 0) {
        output.push_back(make_spike(now.time, base + static_cast<std::int32_t>(now.index)));
      }
    }
  }

 private:
  struct Arrival {
    TimeNs time;
    std::size_t population;
    std::uint32_t index;
    bool operator>(const Arrival& other) const {
      return std::tie(time, population, index) >
             std::tie(other.time, other.population, other.index);
    }
  };

  void send(std::size_t population, std::uint32_t index, TimeNs time, TimeNs earliest) {
    for (const NetworkProjection* projection : outgoing_[population]) {
      const TimeNs arrival = std::max(time + projection->delay, earliest);
      for (const std::uint32_t target : targets(*projection, index)) {
        queue_.push({arrival, projection->to, target});
      }
    }
  }

  const ChannelMap channels_;
  const std::vector<std::vector<const NetworkProjection*>> outgoing_;
  std::priority_queue<Arrival, std::vector<Arrival>, std::greater<>> queue_;
};

}  // namespace

std::unique_ptr<Simulation> make_offgrid_simulation(const NetworkFile& network) {
  return std::make_unique<OffgridSimulation>(network);
}

}  // namespace spikeloop::neurons
