// Where samples come from: the activities of an encoder's neurons, and what is to be decoded.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "spikeloop/core/node.hpp"
#include "spikeloop/core/time.hpp"

namespace spikeloop::fit {

/// A moment, every neuron's activity in Hz, and the wanted outputs.
struct Sample {
  double time_s = 0;  ///< of a moment; 0 for static inputs
  std::span<const double> input;
  std::span<const double> activities;
  std::span<const double> targets;
};
using TakeSample = std::function<void(const Sample&)>;

/// The represented function: of the input, one number an output.
using Function = std::function<void(std::span<const double> input, std::span<double> outputs)>;

/// An encoder whose weights are wanted. The class has one continuous input and one spike output.
struct Encoder {
  const NodeClass* node_class = nullptr;
  Parameters parameters;
  std::string name;  ///< keys its random numbers, as the section's label does
  std::uint64_t seed = 1;
  std::uint32_t dimensions = 1;
  std::uint32_t neurons = 100;
  double radius = 1;  ///< inputs are at most so long
  double bound = 1;   ///< nor is any component of theirs further from 0
};

/// Steady rates at `points` inputs drawn from the ball of the encoder's radius; of each neuron from
/// the intervals between its spikes. `stream` names another set of points.
void sample_rates(const Encoder& encoder, std::uint32_t points, std::uint64_t stream,
                  const Function& function, std::uint32_t outputs, const TakeSample& take);

/// How a run with a changing input is sampled.
struct RunSettings {
  TimeNs tick = 1'000'000;
  double tau_s = 0.03;  ///< of the decoder's exponential kernel
  double duration_s = 60;
  double cutoff_Hz = 2;     ///< highest frequency of the input
  std::uint32_t every = 5;  ///< ticks between two samples
};

/// Spikes filtered with the decoder's kernel  exp(-t / tau) / tau, while the input is band-limited
/// noise of root-mean-square length radius / 2; the targets are filtered alike, so that weights do
/// not try to undo the kernel.
void sample_spikes(const Encoder& encoder, const RunSettings& settings, const Function& function,
                   std::uint32_t outputs, const TakeSample& take);

/// Spikes and a signal that were recorded together.
struct Recording {
  std::span<const Spike> spikes;
  std::uint32_t neurons = 0;
  std::span<const TimeNs> times;   ///< of the signal's rows, each of which holds until the next
  std::span<const double> values;  ///< rows x width
  std::uint32_t width = 0;
  TimeNs end = 0;  ///< of what both have
};

/// Simulated time at the beginning of a run that gives no samples yet.
double settling_time_s(const RunSettings& settings);

/// As sample_spikes(), from the moment at which the signal begins.
/// @throws ConfigurationError when the signal has no value.
void sample_recording(const Recording& recording, const RunSettings& settings,
                      const Function& function, std::uint32_t outputs, const TakeSample& take);

/// The kernel's sums over the spikes of a run.
class FilteredSpikes {
 public:
  FilteredSpikes(std::uint32_t neurons, double tau_s);

  /// Up to the end of the interval; spikes of it in any order.
  void advance(const Interval& interval, std::span<const Spike> spikes);
  std::span<const double> activities() const { return sums_; }

 private:
  double tau_;  // ns
  std::vector<double> sums_;
};

}  // namespace spikeloop::fit
