#include <algorithm>
#include <queue>
#include <tuple>

#include "simulation.hpp"

namespace spikeloop::neurons {

namespace {

// Repeaters alone, at exact times: a queue of spikes on their way.
class OffgridSimulation final : public Simulation {
 public:
  OffgridSimulation(const NetworkFile& network, const Seeding& seeding)
      : network_(network), channels_(network), outgoing_(outgoing(network)) {
    for (std::size_t i = 0; i < network.populations.size(); ++i) {
      if (network.populations[i].model == NeuronModel::poisson) {
        trains_.push_back(
            {i, PoissonTrains(network.populations[i], seeding.stream(network.populations[i]))});
      }
    }
  }

  void set_signal(std::span<const double>, TimeNs) override {}

  void advance(Interval interval, std::span<const Spike> input,
               std::vector<std::vector<Spike>>& output) override {
    for (const Spike& spike : input) {
      const ChannelMap::Member member = channels_.input(spike.channel);
      send(member.population, member.index, spike.time_ns, interval.begin + 1);
    }
    for (Trains& trains : trains_) {
      for (; trains.spikes.due(interval.end); trains.spikes.advance()) {
        const PoissonTrains::Next next = trains.spikes.next();
        fire(trains.population, next.member, next.time, output);
      }
    }
    while (!queue_.empty() && queue_.top().time <= interval.end) {
      const Arrival now = queue_.top();
      queue_.pop();
      fire(now.population, now.index, now.time, output);
    }
  }

  double potential(std::size_t, std::uint32_t) const override { return 0.0; }
  std::span<const double> learned(std::size_t) override { return {}; }

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
    for (const std::size_t i : outgoing_[population]) {
      const NetworkProjection& projection = network_.projections[i];
      const TimeNs arrival = std::max(time + projection.delay, earliest);
      for (const std::uint32_t target : targets(projection, index)) {
        queue_.push({arrival, projection.to, target});
      }
    }
  }

  void fire(std::size_t population, std::uint32_t index, TimeNs time,
            std::vector<std::vector<Spike>>& output) {
    send(population, index, time, time + 1);
    const auto channel = static_cast<std::int32_t>(index);
    if (const std::int32_t base = channels_.output_base(population); base >= 0) {
      output[0].push_back(make_spike(time, base + channel));
    }
    if (const std::size_t recorded = channels_.recorded(population); recorded != 0) {
      output[recorded].push_back(make_spike(time, channel));
    }
  }

  struct Trains {
    std::size_t population;
    PoissonTrains spikes;
  };

  const NetworkFile& network_;
  const ChannelMap channels_;
  const std::vector<std::vector<std::size_t>> outgoing_;
  std::vector<Trains> trains_;
  std::priority_queue<Arrival, std::vector<Arrival>, std::greater<>> queue_;
};

}  // namespace

std::unique_ptr<Simulation> make_offgrid_simulation(const NetworkFile& network,
                                                    const Seeding& seeding) {
  return std::make_unique<OffgridSimulation>(network, seeding);
}

}  // namespace spikeloop::neurons
