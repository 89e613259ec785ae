// Piecewise constant signals for tests of encoders.
#pragma once

#include <random>
#include <vector>

#include "harness.hpp"

namespace spikeloop::testing {

/// Value i holds over (i * period, (i + 1) * period].
struct SampledSignal {
  TimeNs period = kMs;
  std::vector<double> values;
};

inline SampledSignal noise(std::size_t count, TimeNs period, unsigned seed = 3) {
  std::mt19937_64 generator(seed);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  SampledSignal signal{period, {}};
  for (std::size_t i = 0; i < count; ++i) {
    signal.values.push_back(uniform(generator));
  }
  return signal;
}

/// Gives the signal to all `width` channels of `node`, with a new revision at each breakpoint, or
/// at each tick.
inline void drive(NodeHarness& node, const SampledSignal& signal, TimeNs tick,
                  bool revise_each_tick = false, std::size_t width = 1) {
  for (std::size_t i = 0; i < signal.values.size(); ++i) {
    const std::vector<double> values(width, signal.values[i]);
    const TimeNs end = signal.period * static_cast<TimeNs>(i + 1);
    node.set_input(values);
    while (node.time() < end) {
      node.step(tick);
      if (revise_each_tick) {
        node.set_input(values);
      }
    }
  }
}

}  // namespace spikeloop::testing
