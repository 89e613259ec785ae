// Rate neurons with input noise, advanced step by step on the grid.
//
// The step is that of NEST's rate_neuron_ipn with linear summation (Hahne et al. 2017, Front.
// Neuroinform. 11:34): exact for the decay and the noise, with the input of the step's begin.
// Learning is the three-factor rule of Jordan, Weidel & Morrison 2019 (Front. Comput. Neurosci.
// 13:46).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "sources.hpp"
#include "spikeloop/config/network_file.hpp"
#include "spikeloop/core/random.hpp"

namespace spikeloop::neurons {

/// All rate neurons of a network. Step n is the interval ((n - 1) h, n h] of the grid.
class Rates {
 public:
  Rates(const NetworkFile& network, const Seeding& seeding);

  /// Takes over the values of the signal_inputs.
  void set_signal(const Currents& currents);
  /// From step - 1 to `step`: all rates, then all weights.
  void advance(std::int64_t step);
  double rate(std::size_t population, std::uint32_t member) const;
  /// The weights of a learning projection; empty for another.
  std::span<const double> learned(std::size_t projection) const;

 private:
  struct Input {
    const NetworkProjection* projection;
    std::size_t source;  // index in populations_, or that of a signal_input
    std::int64_t delay;  // in steps
    std::vector<double> weight;
  };
  struct Population {
    Population(const NetworkPopulation& of, std::size_t index, const RandomStream& stream,
               TimeNs resolution);

    std::span<double> row(std::int64_t step) {
      return std::span(history).subspan(static_cast<std::size_t>(step % depth) * size, size);
    }

    std::size_t index;
    NeuronModel model;
    RateParameters p;
    std::size_t size;
    RandomStream stream;
    double decay;            // P1
    double gain;             // P2
    double noise;            // of a standard normal number
    std::int64_t depth = 2;  // rows of the history
    std::vector<double> history{};
    std::vector<double> driven{};   // by signals
    std::vector<double> sum{};      // H
    std::vector<double> normals{};  // of four steps
    std::int64_t block = -1;        // which four
    std::vector<Input> signals{};
    std::vector<Input> inputs{};
  };
  struct Learner {
    std::size_t projection;
    std::size_t target;  // indices in populations_
    std::size_t input;   // of the target
    std::size_t reward;
    std::int64_t delay;  // of the trace, in steps
    double rate;         // A times the step in ms
    double theta;
    double lowest;
    double highest;
  };

  void add_projection(std::size_t index, const NetworkFile& network);
  void collect(Population& population, std::int64_t step);
  static void draw(Population& population, std::int64_t step);
  static void move(Population& population, std::int64_t step);
  void learn(const Learner& learner, std::int64_t step);

  std::vector<std::size_t> place_;  // in populations_, by the network's population
  std::vector<Population> populations_;
  std::vector<Learner> learners_;
  std::int64_t now_ = 0;
};

}  // namespace spikeloop::neurons
