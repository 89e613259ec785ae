#include <algorithm>

#include "group.hpp"
#include "plasticity.hpp"
#include "rates.hpp"
#include "simulation.hpp"

namespace spikeloop::neurons {

namespace {

// The step in which a time lies: times are rounded up to the grid. For a negative time, too.
std::int64_t step_of(TimeNs time, TimeNs resolution) {
  return time / resolution + (time % resolution > 0 ? 1 : 0);
}

// How often learning synapses are all brought up to date, so that no history grows for ever.
constexpr TimeNs kSettleEvery = kNsPerSecond;

class GridSimulation final : public Simulation {
 public:
  GridSimulation(const NetworkFile& network, const Seeding& seeding, TimeNs begin)
      : network_(network),
        channels_(network),
        currents_(network, seeding),
        settle_every_(std::max<std::int64_t>(1, kSettleEvery / network.resolution)),
        routes_(network.populations.size()),
        learning_(network.populations.size()),
        rewarding_(network.populations.size()),
        plasticity_(network.projections.size()),
        trains_(network.populations.size()) {
    std::vector<TimeNs> longest(network.populations.size(), 0);
    for (const NetworkProjection& projection : network.projections) {
      longest[projection.to] = std::max(longest[projection.to], projection.delay);
    }
    for (std::size_t i = 0; i < network.populations.size(); ++i) {
      const NetworkPopulation& population = network.populations[i];
      groups_.push_back(
          make_group(population, network.resolution, longest[i] / network.resolution));
      if (population.model == NeuronModel::poisson) {
        trains_[i] = std::make_unique<PoissonTrains>(population, seeding.stream(population));
        trains_[i]->advance(begin, [](std::uint32_t, TimeNs) {});
      }
    }
    if (std::ranges::any_of(network.populations,
                            [](const auto& population) { return is_rate(population.model); })) {
      rates_ = std::make_unique<Rates>(network, seeding);
    }
    add_routes();
  }

  void set_signal(std::span<const double> values, TimeNs now) override {
    currents_.set_signal(values);
    if (rates_) {
      rates_->set_signal(currents_);
    }
    for (const Reward& reward : reward_signals_) {
      reward.plasticity->reward_signal(currents_.total(reward.population),
                                       now / network_.resolution);
    }
  }

  // Within a step: first what comes from outside, by (time, channel), then the populations in the
  // file's order. Every delay is at least one step, so this order shows in sums of weights only,
  // and as it does not know the interval the result does not depend on the tick.
  void advance(Interval interval, std::span<const Spike> input,
               std::vector<std::vector<Spike>>& output) override {
    const std::int64_t last = interval.end / network_.resolution;
    std::size_t next = 0;
    for (std::int64_t step = interval.begin / network_.resolution + 1; step <= last; ++step) {
      currents_.flow(step, groups_);
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
      if (rates_) {
        rates_->advance(step);
      }
      if (learns_ && step % settle_every_ == 0) {
        settle(step);
      }
    }
    now_ = last;
  }

  double value(std::size_t population, std::uint32_t member) const override {
    return is_rate(network_.populations[population].model) ? rates_->rate(population, member)
                                                           : groups_[population]->potential(member);
  }

  std::span<const double> learned(std::size_t projection) override {
    if (!plasticity_[projection]) {
      return rates_ ? rates_->learned(projection) : std::span<const double>();
    }
    plasticity_[projection]->settle(now_);
    return plasticity_[projection]->weights();
  }

  std::span<const double> learned_so_far(std::size_t projection) const override {
    if (plasticity_[projection]) {
      return plasticity_[projection]->weights();
    }
    return rates_ ? rates_->learned(projection) : std::span<const double>();
  }

 private:
  // Where the spikes of a population go.
  struct Route {
    const NetworkProjection* projection;
    std::int64_t delay;  // in steps
    Group* to;
    Plasticity* plasticity;  // none where nothing is learned
  };
  // Whom the spikes, or the signal, of a population reward.
  struct Reward {
    std::size_t population;
    Plasticity* plasticity;
    std::int64_t delay;
  };

  void add_routes() {
    for (std::size_t i = 0; i < network_.projections.size(); ++i) {
      const NetworkProjection& projection = network_.projections[i];
      if (!projection.plasticity || projection.plasticity->rule == PlasticityRule::reward_hebbian) {
        continue;
      }
      plasticity_[i] = make_plasticity(projection, network_.resolution);
      learns_ = true;
      learning_[projection.to].push_back(plasticity_[i].get());
      if (projection.plasticity->rule == PlasticityRule::stdp_dopamine) {
        add_reward(*projection.plasticity, plasticity_[i].get());
      }
    }
    const auto leaving = outgoing(network_);
    for (std::size_t from = 0; from < leaving.size(); ++from) {
      for (const std::size_t i : leaving[from]) {
        const NetworkProjection& projection = network_.projections[i];
        routes_[from].push_back({&projection, projection.delay / network_.resolution,
                                 groups_[projection.to].get(), plasticity_[i].get()});
      }
    }
  }

  void add_reward(const NetworkPlasticity& rule, Plasticity* plasticity) {
    const Reward reward{rule.reward, plasticity, rule.reward_delay / network_.resolution};
    if (network_.populations[rule.reward].model == NeuronModel::signal_input) {
      reward_signals_.push_back(reward);
    } else {
      rewarding_[rule.reward].push_back(reward);
    }
  }

  void update(std::size_t population, std::int64_t step, std::vector<std::vector<Spike>>& output) {
    fired_.clear();
    if (groups_[population]) {
      groups_[population]->update(step, fired_);
    } else if (trains_[population]) {
      trains_[population]->advance(
          step * network_.resolution,
          [this](std::uint32_t member, TimeNs) { fired_.push_back(member); });
    } else {
      return;
    }
    const std::int32_t base = channels_.output_base(population);
    const std::size_t recorded = channels_.recorded(population);
    for (const std::uint32_t index : fired_) {
      send(population, index, step, step + 1);
      for (Plasticity* plasticity : learning_[population]) {
        plasticity->target_fired(index, step);
      }
      const auto channel = static_cast<std::int32_t>(index);
      if (base >= 0) {
        output[0].push_back(make_spike(step * network_.resolution, base + channel));
      }
      if (recorded != 0) {
        output[recorded].push_back(make_spike(step * network_.resolution, channel));
      }
    }
  }

  // A spike of `step` acts its delay later, but not before step `earliest`.
  void send(std::size_t population, std::uint32_t index, std::int64_t step, std::int64_t earliest) {
    for (const Route& route : routes_[population]) {
      const std::int64_t arrival = std::max(step + route.delay, earliest);
      route.to->receive(arrival, targets(*route.projection, index),
                        route.plasticity == nullptr
                            ? weights(*route.projection, index)
                            : route.plasticity->source_fired(index, arrival - route.delay));
    }
    for (const Reward& reward : rewarding_[population]) {
      reward.plasticity->reward_fired(std::max(step + reward.delay, earliest));
    }
  }

  void settle(std::int64_t step) {
    for (const auto& plasticity : plasticity_) {
      if (plasticity) {
        plasticity->settle(step);
      }
    }
  }

  const NetworkFile& network_;
  const ChannelMap channels_;
  Currents currents_;
  const std::int64_t settle_every_;
  std::vector<std::vector<Route>> routes_;          // by population
  std::vector<std::vector<Plasticity*>> learning_;  // those into a population
  std::vector<std::vector<Reward>> rewarding_;      // those that a population rewards
  std::vector<Reward> reward_signals_;
  std::vector<std::unique_ptr<Plasticity>> plasticity_;  // by projection; none where nothing learns
  std::vector<std::unique_ptr<PoissonTrains>> trains_;   // by population; none for others
  std::vector<std::unique_ptr<Group>> groups_;  // by population; none for sources and rates
  std::unique_ptr<Rates> rates_;                // none where there are none
  std::vector<std::uint32_t> fired_;
  std::int64_t now_ = 0;
  bool learns_ = false;
};

}  // namespace

std::unique_ptr<Simulation> make_grid_simulation(const NetworkFile& network, const Seeding& seeding,
                                                 TimeNs begin) {
  return std::make_unique<GridSimulation>(network, seeding, begin);
}

}  // namespace spikeloop::neurons
