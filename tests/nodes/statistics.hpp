// Statistics that the tests compare with theory.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace spikeloop::testing {

/// The largest distance between the samples' distribution and `cumulative`. Under the hypothesis it
/// exceeds 1.95 / sqrt(n) with probability 0.001.
template <typename Cumulative>
double kolmogorov_smirnov(std::vector<double> samples, Cumulative&& cumulative) {
  std::sort(samples.begin(), samples.end());
  const auto n = static_cast<double>(samples.size());
  double distance = 0.0;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const double p = cumulative(samples[i]);
    distance =
        std::max({distance, p - static_cast<double>(i) / n, static_cast<double>(i + 1) / n - p});
  }
  return distance;
}

inline double mean(const std::vector<double>& samples) {
  double sum = 0.0;
  for (const double sample : samples) {
    sum += sample;
  }
  return sum / static_cast<double>(samples.size());
}

inline double variance(const std::vector<double>& samples) {
  const double center = mean(samples);
  double sum = 0.0;
  for (const double sample : samples) {
    sum += (sample - center) * (sample - center);
  }
  return sum / static_cast<double>(samples.size() - 1);
}

}  // namespace spikeloop::testing
