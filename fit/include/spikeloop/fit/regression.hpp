// Decoding weights by regularised least squares.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace spikeloop::fit {

/// How well weights decode. Errors are root-mean-square, in the targets' unit.
struct Errors {
  std::vector<double> of_output;
  double total = 0;  ///< over all outputs
  std::uint64_t samples = 0;
};

/// Finds the weights W that minimise  |A W' - Y|^2 / m + (r max A)^2 |W|^2  for m samples, where a
/// sample is the activity of every neuron (a row of A) and the wanted outputs (a row of Y): Nengo's
/// solver LstsqL2 with reg = r (Eliasmith & Anderson 2003, ch. 2). Samples are added up, not kept:
/// memory is two matrices of neurons x neurons.
class Regression {
 public:
  Regression(std::uint32_t neurons, std::uint32_t outputs);
  ~Regression();

  /// `activities` has one number a neuron, `targets` one an output.
  void add(std::span<const double> activities, std::span<const double> targets);

  /// outputs x neurons, row by row.
  /// @throws ConfigurationError when there is no sample, no neuron was ever active, or the
  /// equations have no solution (regularisation 0 and neurons that do the same).
  std::vector<double> solve(double regularisation) const;
  /// Of these weights, over the samples that were added.
  Errors errors(std::span<const double> weights) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Adds up the errors of some weights over samples.
class Evaluation {
 public:
  /// `weights` are outputs x neurons and must outlive it.
  Evaluation(std::span<const double> weights, std::uint32_t neurons);

  /// Returns what the weights decode; valid until the next call.
  std::span<const double> add(std::span<const double> activities, std::span<const double> targets);
  Errors errors() const;

 private:
  std::span<const double> weights_;
  std::size_t neurons_;
  std::vector<double> decoded_;
  std::vector<double> squares_;
  std::uint64_t samples_ = 0;
};

}  // namespace spikeloop::fit
