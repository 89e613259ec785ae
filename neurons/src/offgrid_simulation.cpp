#include <algorithm>
#include <cmath>
#include <queue>
#include <tuple>

#include "simulation.hpp"

namespace spikeloop::neurons {

namespace {

constexpr double kLatest = 4e18;     // ns: later than any run
constexpr std::uint64_t kSpike = 0;  // in place of a crossing's number

// iaf_psc_delta between events: its membrane potential relaxes towards that of I_e, in closed form,
// and when that lies above the threshold, the time of the crossing is known, too.
class ExactNeurons {
 public:
  explicit ExactNeurons(const NetworkPopulation& population)
      : p_(population.parameters),
        threshold_(p_.V_th - p_.E_L),
        driven_(p_.I_e * p_.tau_m / p_.C_m),
        refractory_(std::llround(p_.t_ref * 1e6)),
        states_(population.size, State{p_.V_m - p_.E_L, 0, -1, kSpike}) {}

  // The potential at a time from `since` on, relative to E_L.
  double at(std::uint32_t i, TimeNs time) const {
    const State& state = states_[i];
    const double left = std::exp(-in_ms(std::max<TimeNs>(time - state.since, 0)) / p_.tau_m);
    return driven_ + (state.potential - driven_) * left;
  }
  double potential(std::uint32_t i, TimeNs time) const { return at(i, time) + p_.E_L; }

  // Weights that arrive together, or a crossing; true when the neuron fires. In the refractory
  // period, its last moment included, spikes are lost.
  bool take(std::uint32_t i, TimeNs time, double weight, bool crossing) {
    State& state = states_[i];
    if (time <= state.refractory_until) {
      return false;
    }
    const double before = crossing ? threshold_ : at(i, time);
    state.potential = std::max(before + weight, p_.V_min - p_.E_L);
    state.since = time;
    if (state.potential < threshold_) {
      return false;
    }
    state = {p_.V_reset - p_.E_L, time + refractory_, time + refractory_, state.number};
    if (refractory_ == 0) {
      state.refractory_until = time - 1;
    }
    return true;
  }

  struct Crossing {
    TimeNs time;
    std::uint64_t number;
  };
  // The crossing that is next if no spike arrives; its number tells it from older ones. Time -1:
  // none.
  Crossing next_crossing(std::uint32_t i) {
    State& state = states_[i];
    ++state.number;
    if (state.potential >= threshold_) {
      return {state.since + 1, state.number};  // V_m at time 0
    }
    if (driven_ <= threshold_) {
      return {-1, state.number};
    }
    const double span = std::log((driven_ - state.potential) / (driven_ - threshold_)) * p_.tau_m;
    return {state.since +
                std::max<TimeNs>(1, static_cast<TimeNs>(std::ceil(std::min(span * 1e6, kLatest)))),
            state.number};
  }
  bool is_next(std::uint32_t i, std::uint64_t number) const { return states_[i].number == number; }

 private:
  struct State {
    double potential;         // at `since`, relative to E_L
    TimeNs since;             // perhaps in the future: the end of the refractory period
    TimeNs refractory_until;  // spikes up to here are lost
    std::uint64_t number;     // of the crossing that is next
  };

  const NeuronParameters p_;
  const double threshold_;
  const double driven_;  // where I_e alone leads
  const TimeNs refractory_;
  std::vector<State> states_;
};

// Events at exact times: a queue of spikes on their way, and of crossings of the threshold.
class OffgridSimulation final : public Simulation {
 public:
  OffgridSimulation(const NetworkFile& network, const Seeding& seeding)
      : network_(network), channels_(network), outgoing_(outgoing(network)) {
    for (std::size_t i = 0; i < network.populations.size(); ++i) {
      const NetworkPopulation& population = network.populations[i];
      const bool neurons = has_membrane(population.model);
      neurons_.push_back(neurons ? std::make_unique<ExactNeurons>(population) : nullptr);
      for (std::uint32_t k = 0; neurons && k < population.size; ++k) {
        expect_crossing(i, k);
      }
      if (population.model == NeuronModel::poisson) {
        trains_.push_back({i, PoissonTrains(population, seeding.stream(population))});
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
      trains.spikes.advance(interval.end, [&](std::uint32_t member, TimeNs time) {
        fire(trains.population, member, time, output);
      });
    }
    while (!queue_.empty() && queue_.top().time <= interval.end) {
      const Arrival now = queue_.top();
      queue_.pop();
      if (neurons_[now.population]) {
        take_together(now, output);
      } else {
        fire(now.population, now.index, now.time, output);
      }
    }
    now_ = interval.end;
  }

  double value(std::size_t population, std::uint32_t member) const override {
    return neurons_[population]->potential(member, now_);
  }
  std::span<const double> learned(std::size_t) override { return {}; }
  std::span<const double> learned_so_far(std::size_t) const override { return {}; }

 private:
  struct Arrival {
    TimeNs time;
    std::size_t population;
    std::uint32_t index;
    std::uint64_t crossing;  // its number; kSpike: a spike
    double weight;

    auto key() const { return std::tie(time, population, index, crossing, weight); }
    bool operator>(const Arrival& other) const { return key() > other.key(); }
    bool together(const Arrival& other) const {
      return time == other.time && population == other.population && index == other.index;
    }
  };

  // What reaches a neuron in one nanosecond acts at once, as on a grid.
  void take_together(const Arrival& first, std::vector<std::vector<Spike>>& output) {
    ExactNeurons& neurons = *neurons_[first.population];
    double weight = 0.0;
    bool crossing = false;
    bool any = false;
    for (Arrival arrival = first;;) {
      const bool spike = arrival.crossing == kSpike;
      const bool valid = spike || neurons.is_next(arrival.index, arrival.crossing);
      weight += spike ? arrival.weight : 0.0;
      crossing = crossing || (valid && !spike);
      any = any || valid;
      if (queue_.empty() || !queue_.top().together(first)) {
        break;
      }
      arrival = queue_.top();
      queue_.pop();
    }
    if (!any) {
      return;  // a crossing that something came before
    }
    if (neurons.take(first.index, first.time, weight, crossing)) {
      fire(first.population, first.index, first.time, output);
    }
    expect_crossing(first.population, first.index);
  }

  void expect_crossing(std::size_t population, std::uint32_t index) {
    const ExactNeurons::Crossing crossing = neurons_[population]->next_crossing(index);
    if (crossing.time >= 0) {
      queue_.push({crossing.time, population, index, crossing.number, 0.0});
    }
  }

  void send(std::size_t population, std::uint32_t index, TimeNs time, TimeNs earliest) {
    for (const std::size_t i : outgoing_[population]) {
      const NetworkProjection& projection = network_.projections[i];
      const TimeNs arrival = std::max(time + projection.delay, earliest);
      const auto to = targets(projection, index);
      const auto weight = weights(projection, index);
      for (std::size_t k = 0; k < to.size(); ++k) {
        queue_.push({arrival, projection.to, to[k], kSpike, weight[k]});
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
  std::vector<std::unique_ptr<ExactNeurons>> neurons_;  // by population; none for others
  std::vector<Trains> trains_;
  std::priority_queue<Arrival, std::vector<Arrival>, std::greater<>> queue_;
  TimeNs now_ = 0;
};

}  // namespace

std::unique_ptr<Simulation> make_offgrid_simulation(const NetworkFile& network,
                                                    const Seeding& seeding) {
  return std::make_unique<OffgridSimulation>(network, seeding);
}

}  // namespace spikeloop::neurons
