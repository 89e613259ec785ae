// The YAML file of the built-in network: populations, connections, output. docs/network-file.md
// describes it. Numbers without a unit are in NEST's units: ms, mV, pF, pA.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "spikeloop/core/error.hpp"
#include "spikeloop/core/parameters.hpp"
#include "spikeloop/core/time.hpp"

namespace spikeloop {

enum class NeuronModel {
  input,
  repeater,
  iaf_psc_delta,
  iaf_psc_exp,
  poisson,
  signal_input,
  step_current,
  sine_current,
  noise_current,
  lin_rate_ipn,
  threshold_lin_rate_ipn,
  sigmoid_rate_ipn
};

/// "input", "repeater", ..., as the key `model` has them.
std::string_view model_name(NeuronModel model);

/// Integrate-and-fire: it has a membrane potential, and synapses with weights.
bool has_membrane(NeuronModel model);
/// It sends a current in place of spikes.
bool is_current(NeuronModel model);
/// A rate neuron with input noise: it sends its rate to other rate neurons.
bool is_rate(NeuronModel model);
/// Nothing can be connected to it.
bool is_source(NeuronModel model);

/// Parameters of a model as data, with NEST's names, units and defaults; empty for a model without
/// any. `rate` of poisson and `values` of step_current, which may be lists, are not among them.
std::vector<ParameterDescription> model_parameters(NeuronModel model);

/// Parameters of the integrate-and-fire models; the defaults are NEST's.
struct NeuronParameters {
  double C_m = 250.0;       ///< membrane capacitance, pF
  double tau_m = 10.0;      ///< membrane time constant, ms
  double t_ref = 2.0;       ///< absolute refractory period, ms
  double E_L = -70.0;       ///< resting potential, mV
  double V_reset = -70.0;   ///< membrane potential after a spike, mV
  double V_th = -55.0;      ///< threshold, mV
  double V_m = -70.0;       ///< membrane potential at time 0, mV; default E_L
  double I_e = 0.0;         ///< constant input current, pA
  double tau_syn_ex = 2.0;  ///< iaf_psc_exp: time constant of excitatory currents, ms
  double tau_syn_in = 2.0;  ///< iaf_psc_exp: time constant of inhibitory currents, ms
  double V_min = -std::numeric_limits<double>::infinity();  ///< iaf_psc_delta: lower bound, mV
};

/// Parameters of the rate neurons; names and defaults are NEST's. With the sum H of weighted rates,
/// tau dX/dt = -lambda X + mu + phi(H) + sqrt(tau) sigma xi.
struct RateParameters {
  double tau = 10.0;                                       ///< time constant, ms
  double lambda = 1.0;                                     ///< passive decay
  double sigma = 1.0;                                      ///< noise
  double mu = 0.0;                                         ///< mean drive
  double g = 1.0;                                          ///< gain of phi
  double theta = 0.0;                                      ///< threshold of phi
  double alpha = std::numeric_limits<double>::infinity();  ///< threshold_lin: upper bound of phi
  double beta = 1.0;                                       ///< sigmoid: slope of phi
  double rate = 0.0;                                       ///< at time 0
};

/// A value that holds from a time on, until the next one's.
struct TimedValue {
  TimeNs time = 0;
  double value = 0.0;
};

/// Parameters of what drives a network from inside.
struct SourceParameters {
  std::vector<TimedValue> steps{};  ///< poisson: rates, Hz; step_current: pA. 0 before the first
  double amplitude = 0.0;           ///< sine_current, pA
  double frequency = 0.0;           ///< sine_current, Hz
  double phase = 0.0;               ///< sine_current, rad
  double offset = 0.0;              ///< sine_current, pA
  double mean = 0.0;                ///< noise_current, pA
  double std = 0.0;                 ///< noise_current, pA
  TimeNs dt = 0;                    ///< noise_current: each value holds that long
};

struct NetworkPopulation {
  std::string name;
  NeuronModel model = NeuronModel::input;
  std::uint32_t size = 0;
  NeuronParameters parameters{};
  SourceParameters source{};
  RateParameters rate{};
  Location where{};
};

enum class PlasticityRule { stdp, stdp_dopamine, reward_hebbian };

/// "stdp", "stdp_dopamine", "reward_hebbian".
std::string_view rule_name(PlasticityRule rule);

/// Learning synapses. Of spike-timing dependent plasticity, names, units and defaults are those of
/// NEST's `stdp_synapse` and `stdp_dopamine_synapse`; the delay is the dendrite's. `reward_hebbian`
/// is for rates.
struct NetworkPlasticity {
  PlasticityRule rule = PlasticityRule::stdp;
  bool nearest = false;     ///< every spike pairs with the one before it alone (symmetric)
  double tau_plus = 20.0;   ///< trace of the source, ms
  double tau_minus = 20.0;  ///< trace of the target, ms
  double lambda = 0.01;     ///< stdp: step of a potentiation, in Wmax
  double alpha = 1.0;       ///< stdp: depression over potentiation
  double mu_plus = 1.0;     ///< stdp: exponent of the weight's dependence, 0 additive
  double mu_minus = 1.0;
  double Wmax = 100.0;      ///< mV, pA or 1, as the weights
  double A_plus = 1.0;      ///< stdp_dopamine: what a pair adds to the eligibility
  double A_minus = 1.5;     ///< stdp_dopamine: what a pair takes from it
  double tau_c = 1000.0;    ///< stdp_dopamine: of the eligibility, ms
  double tau_n = 200.0;     ///< stdp_dopamine: of the dopamine, ms
  double b = 0.0;           ///< stdp_dopamine: baseline of the dopamine
  double A = 0.01;          ///< reward_hebbian: learning rate, per ms
  double theta = 0.0;       ///< reward_hebbian: the target learns above this rate
  double Wmin = 0.0;        ///< not of stdp
  std::size_t reward = 0;   ///< not of stdp: index of the population
  TimeNs trace_delay = 0;   ///< reward_hebbian: age of the rates that learn
  TimeNs reward_delay = 0;  ///< stdp_dopamine: from its spikes to the synapses
  std::string save{};       ///< file for the weights of the end; empty: none
  Location where{};
};

/// The synapses of one entry of `connections`, grouped by source: source i has the synapses
/// row_start[i] .. row_start[i + 1] - 1.
struct NetworkProjection {
  std::size_t from = 0;  ///< index of the population
  std::size_t to = 0;
  TimeNs delay = 0;                      ///< 0: of a current or a rate that acts at once
  std::string rule;                      ///< as written; "array" from a Python function
  std::vector<std::uint64_t> row_start;  ///< size of `from` + 1 entries
  std::vector<std::uint32_t> target;
  std::vector<double> weight;  ///< mV (iaf_psc_delta), pA (iaf_psc_exp), 1 (all others)
  std::optional<NetworkPlasticity> plasticity{};
  Location where{};
};

/// What is recorded of a population, each on an output port of its own.
struct NetworkRecord {
  std::size_t population = 0;
  bool spikes = false;                     ///< port NAME_spikes
  std::vector<std::uint32_t> potential{};  ///< port NAME_V_m: of these members, in this order
  TimeNs interval = 0;                     ///< between two rows of potentials; 0: every tick
  Location where{};
};

struct NetworkFile {
  std::string path;
  TimeNs resolution = 0;        ///< the grid; 0: no grid (`resolution: off`)
  Location resolution_where{};  ///< the file alone when the default holds
  std::vector<NetworkPopulation> populations;
  std::vector<NetworkProjection> projections;
  std::vector<std::size_t> output;       ///< populations whose spikes leave by port `out`, in order
  std::vector<std::size_t> potential{};  ///< whose membrane potentials leave by port `potential`
  std::vector<std::size_t> rates{};      ///< whose rates leave by port `rates`
  std::vector<NetworkRecord> record{};

  std::uint32_t input_width() const;      ///< channels of port `in`: sum of the input populations
  std::uint32_t signal_width() const;     ///< channels of port `signal`: of the signal_inputs
  std::uint32_t output_width() const;     ///< channels of port `out`
  std::uint32_t potential_width() const;  ///< channels of port `potential`
  std::uint32_t rates_width() const;      ///< channels of port `rates`
  /// A tick must be a whole number of resolutions, and an interval of recording of ticks.
  /// @throws ConfigurationError with both lengths and what to write.
  void check_tick(TimeNs tick) const;
  /// A time must be a whole number of resolutions. @throws as check_tick.
  void check_grid(TimeNs time) const;
};

/// Reads a weight file named in `rule`; gets its path relative to the working directory.
/// Rows are targets, columns are sources.
using NetworkWeightLoader = std::function<WeightTable(const std::string& path)>;

/// Parses the text of a network file; weight files are looked up beside `path`.
/// @throws ConfigurationError with file, line and column, the key, the value and a remedy.
NetworkFile parse_network(const std::string& text, const std::string& path,
                          const NetworkWeightLoader& load_weights);

/// Reads and parses a network file and the weight files it names; a Python function
/// (network_script.hpp) is run with the defaults of its arguments.
/// @throws FileError when it cannot be read, ConfigurationError as parse_network.
NetworkFile read_network_file(const std::string& path);

}  // namespace spikeloop
