// Spike trains of random networks against an independent implementation. It knows no propagators,
// steps or ring buffers: at every grid point it writes down the closed form of each membrane
// potential since the last reset, a sum over all spikes that ever arrived, in long double.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <cmath>
#include <random>

#include "run_network.hpp"

namespace spikeloop::test {
namespace {

using Real = long double;
constexpr int kNeurons = 20;
constexpr int kInputs = 10;

struct Synapse {
  int source;
  int target;
  double weight;
};

struct RandomNetwork {
  bool exponential = true;
  double resolution = 0.1;
  double tau_syn_ex = 2.0;
  double tau_syn_in = 5.0;
  double I_e = 330.0;
  double input_delay = 0.4;
  double delay = 1.3;
  double t_ref = 2.0;
  std::vector<Synapse> from_input;
  std::vector<Synapse> recurrent;
};

constexpr Real kTauM = 10;
constexpr Real kCm = 250;

std::string pairs_text(const std::vector<Synapse>& synapses) {
  std::string text;
  for (const Synapse& s : synapses) {
    text +=
        fmt::format("{}[{}, {}, {:.17g}]", text.empty() ? "" : ", ", s.source, s.target, s.weight);
  }
  return text;
}

std::string yaml(const RandomNetwork& n) {
  const char* unit = n.exponential ? "pA" : "mV";
  return fmt::format(
      "resolution: {} ms\n"
      "populations:\n"
      "  input: {{model: input, size: {}}}\n"
      "  cells: {{model: {}, size: {}, parameters: {{I_e: {} pA, V_reset: -72 mV, t_ref: {} "
      "ms{}}}}}\n"
      "connections:\n"
      "  - {{from: input, to: cells, rule: pairs, weight: 1 {}, delay: {} ms, pairs: [{}]}}\n"
      "  - {{from: cells, to: cells, rule: pairs, weight: 1 {}, delay: {} ms, pairs: [{}]}}\n"
      "output: [cells]\n",
      n.resolution, kInputs, n.exponential ? "iaf_psc_exp" : "iaf_psc_delta", kNeurons, n.I_e,
      n.t_ref,
      n.exponential ? fmt::format(", tau_syn_ex: {}, tau_syn_in: {}", n.tau_syn_ex, n.tau_syn_in)
                    : std::string(),
      unit, n.input_delay, pairs_text(n.from_input), unit, n.delay, pairs_text(n.recurrent));
}

struct Arrival {
  Real time;  // ms
  Real weight;
};

// Membrane potential over E_L at time t of a neuron that left `start` at time t0.
Real potential(const RandomNetwork& n, const std::vector<Arrival>& arrivals, Real start, Real t0,
               Real t) {
  const Real leak = std::exp(-(t - t0) / kTauM);
  Real value = start * leak + Real(n.I_e) * kTauM / kCm * (1 - leak);
  const Real hair = 1e-9L;
  for (const Arrival& a : arrivals) {
    if (!n.exponential) {
      // Spikes that arrived up to the end of the refractory period are lost.
      value +=
          a.time > t0 + hair && a.time < t + hair ? a.weight * std::exp(-(t - a.time) / kTauM) : 0;
      continue;
    }
    const Real tau = a.weight >= 0 ? n.tau_syn_ex : n.tau_syn_in;
    const Real from = std::max(a.time, t0);
    if (from >= t) {
      continue;
    }
    // (1 / C_m) * integral from `from` to t of exp(-(t - s) / tau_m) exp(-(s - arrival) / tau) ds
    const Real current = a.weight * std::exp(-(from - a.time) / tau);
    const Real span = t - from;
    value += tau == kTauM ? current * span / kCm * std::exp(-span / kTauM)
                          : current * kTauM * tau / (kCm * (kTauM - tau)) *
                                (std::exp(-span / kTauM) - std::exp(-span / tau));
  }
  return value;
}

std::vector<std::pair<TimeNs, int>> reference(const RandomNetwork& n, const Spikes& input,
                                              TimeNs duration) {
  const TimeNs h = ms(n.resolution);
  const auto in_ms = [](TimeNs time) { return static_cast<Real>(time) / 1e6L; };
  std::vector<std::vector<Arrival>> arrivals(kNeurons);
  for (const Spike& spike : input) {
    const TimeNs on_grid = (spike.time_ns + h - 1) / h * h;
    for (const Synapse& s : n.from_input) {
      if (s.source == spike.channel) {
        arrivals[s.target].push_back({in_ms(on_grid + ms(n.input_delay)), s.weight});
      }
    }
  }
  std::vector<Real> start(kNeurons, 0), since(kNeurons, 0);
  std::vector<std::pair<TimeNs, int>> spikes;
  const TimeNs dead = static_cast<TimeNs>(std::ceil(n.t_ref / n.resolution - 1e-9)) * h;
  for (TimeNs now = h; now <= duration; now += h) {
    for (int i = 0; i < kNeurons; ++i) {
      const bool refractory = in_ms(now) < since[i] + 1e-9L;
      if (refractory || potential(n, arrivals[i], start[i], since[i], in_ms(now)) < 15) {
        continue;
      }
      spikes.emplace_back(now, i);
      start[i] = -2;
      since[i] = in_ms(now + dead);
      for (const Synapse& s : n.recurrent) {
        if (s.source == i) {
          arrivals[s.target].push_back({in_ms(now + ms(n.delay)), s.weight});
        }
      }
    }
  }
  return spikes;
}

std::vector<Synapse> random_synapses(int sources, double probability, double weight,
                                     std::mt19937_64& random) {
  std::uniform_real_distribution<double> uniform(0, 1);
  std::vector<Synapse> synapses;
  for (int i = 0; i < sources; ++i) {
    for (int j = 0; j < kNeurons; ++j) {
      if (uniform(random) < probability) {
        const double sign = uniform(random) < 0.3 ? -2.0 : 1.0;
        synapses.push_back({i, j, sign * weight * (0.5 + uniform(random))});
      }
    }
  }
  return synapses;
}

Spikes random_input(TimeNs duration, std::mt19937_64& random) {
  std::uniform_int_distribution<TimeNs> time(1, duration);
  std::uniform_int_distribution<int> channel(0, kInputs - 1);
  Spikes spikes;
  for (int i = 0; i < 250; ++i) {
    spikes.push_back(make_spike(time(random), channel(random)));
  }
  std::sort(spikes.begin(), spikes.end(), spike_before);
  return spikes;
}

struct Case {
  const char* name;
  bool exponential;
  double resolution;
  double tau_syn_ex;
  double t_ref;
  double weight;
};

class RandomNetworks : public testing::TestWithParam<Case> {
 protected:
  RandomNetwork make(std::mt19937_64& random) const {
    const Case c = GetParam();
    RandomNetwork n;
    n.exponential = c.exponential;
    n.resolution = c.resolution;
    n.tau_syn_ex = c.tau_syn_ex;
    n.t_ref = c.t_ref;
    n.from_input = random_synapses(kInputs, 0.4, c.weight, random);
    n.recurrent = random_synapses(kNeurons, 0.2, c.weight, random);
    if (c.resolution == 0.5) {
      n.input_delay = 0.5;
      n.delay = 1.5;
    }
    return n;
  }
};

TEST_P(RandomNetworks, SpikeTrainsEqualTheReference) {
  const TimeNs duration = 120 * kMs;
  for (const unsigned seed : {1u, 2u}) {
    std::mt19937_64 random(seed);
    const RandomNetwork n = make(random);
    const Spikes input = random_input(duration, random);
    const auto wanted = reference(n, input, duration);
    ASSERT_GT(wanted.size(), 50u) << "too quiet to tell anything";
    EXPECT_EQ(plain(run(parse(yaml(n)), input, duration)), wanted);
  }
}

TEST_P(RandomNetworks, SpikeTrainsDoNotDependOnTheTick) {
  const TimeNs duration = 500 * kMs;
  std::mt19937_64 random(3);
  const NetworkFile network = parse(yaml(make(random)));
  Spikes input = random_input(duration, random);
  for (int k = 1; k < 50; ++k) {  // on the ticks' borders, too
    input.push_back(make_spike(k * 10 * kMs, k % kInputs));
  }
  const auto wanted =
      plain(run(network, input, duration, ms(network.resolution == 500'000 ? 0.5 : 0.1)));
  ASSERT_GT(wanted.size(), 100u);
  for (const TimeNs tick : {1 * kMs, 10 * kMs, 50 * kMs}) {
    EXPECT_EQ(plain(run(network, input, duration, tick)), wanted) << format_time(tick);
  }
}

INSTANTIATE_TEST_SUITE_P(Networks, RandomNetworks,
                         testing::Values(Case{"exponential", true, 0.1, 2.0, 2.0, 300.0},
                                         Case{"equal_time_constants", true, 0.1, 10.0, 2.0, 100.0},
                                         Case{"coarse_grid", true, 0.5, 2.0, 1.75, 300.0},
                                         Case{"no_refractory_period", true, 0.1, 3.0, 0.0, 300.0},
                                         Case{"delta", false, 0.1, 2.0, 2.0, 3.0},
                                         Case{"delta_coarse_grid", false, 0.5, 2.0, 0.75, 3.0}),
                         [](const auto& test) { return std::string(test.param.name); });

}  // namespace
}  // namespace spikeloop::test
