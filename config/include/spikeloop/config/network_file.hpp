// The YAML file of the built-in network: populations, connections, output. docs/network-file.md
// describes it. Numbers without a unit are in NEST's units: ms, mV, pF, pA.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "spikeloop/core/error.hpp"
#include "spikeloop/core/parameters.hpp"
#include "spikeloop/core/time.hpp"

namespace spikeloop {

enum class NeuronModel { input, repeater, iaf_psc_delta, iaf_psc_exp };

/// "input", "repeater", "iaf_psc_delta", "iaf_psc_exp".
std::string_view model_name(NeuronModel model);

/// Parameters of a model as data, with NEST's names, units and defaults; empty for input and
/// repeater.
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

struct NetworkPopulation {
  std::string name;
  NeuronModel model = NeuronModel::input;
  std::uint32_t size = 0;
  NeuronParameters parameters{};
  Location where{};
};

/// The synapses of one entry of `connections`, grouped by source: source i has the synapses
/// row_start[i] .. row_start[i + 1] - 1.
struct NetworkProjection {
  std::size_t from = 0;  ///< index of the population
  std::size_t to = 0;
  TimeNs delay = 0;
  std::string rule;                      ///< as written
  std::vector<std::uint64_t> row_start;  ///< size of `from` + 1 entries
  std::vector<std::uint32_t> target;
  std::vector<double> weight;  ///< mV (iaf_psc_delta), pA (iaf_psc_exp), 1 (repeater)
  Location where{};
};

struct NetworkFile {
  std::string path;
  TimeNs resolution = 0;        ///< the grid; 0: no grid (`resolution: off`)
  Location resolution_where{};  ///< the file alone when the default holds
  std::vector<NetworkPopulation> populations;
  std::vector<NetworkProjection> projections;
  std::vector<std::size_t> output;  ///< populations whose spikes leave by port `out`, in order

  std::uint32_t input_width() const;   ///< channels of port `in`: sum of the input populations
  std::uint32_t output_width() const;  ///< channels of port `out`
  /// A tick must be a whole number of resolutions.
  /// @throws ConfigurationError with both lengths and what to write.
  void check_tick(TimeNs tick) const;
};

/// Reads a weight file named in `rule`; gets its path relative to the working directory.
/// Rows are targets, columns are sources.
using NetworkWeightLoader = std::function<WeightTable(const std::string& path)>;

/// Parses the text of a network file; weight files are looked up beside `path`.
/// @throws ConfigurationError with file, line and column, the key, the value and a remedy.
NetworkFile parse_network(const std::string& text, const std::string& path,
                          const NetworkWeightLoader& load_weights);

/// Reads and parses a network file and the weight files it names.
/// @throws FileError when it cannot be read, ConfigurationError as parse_network.
NetworkFile read_network_file(const std::string& path);

}  // namespace spikeloop
