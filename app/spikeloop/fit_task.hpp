// What `spikeloop fit` is asked for, and what it finds.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "spikeloop/fit/regression.hpp"

namespace spikeloop::app {

inline constexpr std::uint32_t kMostNeurons = 10'000;  ///< their two matrices have 1.6 GB

struct FitTask {
  std::string encoder;            ///< node class; empty: recorded spikes
  std::vector<std::string> keys;  ///< KEY=VALUE of the encoder
  std::string name = "encoder";
  std::uint64_t seed = 1;
  std::uint32_t dimensions = 1;
  std::uint32_t neurons = 100;
  std::string function;  ///< of the represented value; empty: the value itself
  bool from_rates = false;
  std::uint32_t points = 0;  ///< of rates; 0: ten a neuron, at least 1000
  double duration_s = 60;
  double cutoff_Hz = 2;
  double tau_s = 0.03;
  double regularisation = 0.01;
  std::string spikes;  ///< recording FILE[:STREAM]
  std::string target;  ///< recording FILE[:STREAM]
  std::string out;
  std::string picture;
};

/// Some held-out samples, for the picture.
struct FitTrace {
  std::vector<double> time_s;  ///< empty for static inputs
  std::vector<double> input;   ///< the first dimension
  std::vector<std::vector<double>> target;
  std::vector<std::vector<double>> decoded;
};

struct FitResult {
  std::uint32_t neurons = 0;
  std::uint32_t outputs = 0;
  std::vector<double> weights;  ///< outputs x neurons
  fit::Errors training;
  fit::Errors held_out;
  std::string section;  ///< what the encoder's section must say; empty for a recording
  double range = 0;     ///< of the held-out targets, greatest minus least
  FitTrace trace;
};

/// Three quarters of the samples are for training, the rest is held out.
/// @throws ConfigurationError that names the option and what to write; FileError of recordings.
FitResult fit_weights(const FitTask& task);

}  // namespace spikeloop::app
