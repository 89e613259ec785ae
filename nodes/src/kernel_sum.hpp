// Sums of exponentially decaying contributions that stay exact over runs of any length.
#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

#include "spikeloop/core/time.hpp"

namespace spikeloop {

/// y_i(t) = sum over contributions (s, a) of a * exp(-(t - s) / tau), for all t >= s.
///
/// A contribution is stored as a * exp((s - r) / tau) relative to a reference time r that all
/// outputs share, and y_i(t) is the stored sum times exp(-(t - r) / tau). Time passes without
/// touching the sums; only once in 32 tau, when another contribution comes, r moves and the sums
/// are scaled. Nothing accumulates with the number of ticks, and compensated addition (the two-sum
/// of Knuth) keeps the number of spikes from doing so.
class KernelSum {
 public:
  KernelSum(std::uint32_t outputs, double tau_seconds)
      : tau_(tau_seconds * 1e9), sum_(outputs, 0.0), error_(outputs, 0.0) {}

  /// Makes ready for contributions up to `end`, not before any `end` given earlier.
  void prepare(TimeNs end);
  /// exp((s - r) / tau): the factor of contributions of time s.
  double factor(TimeNs time) const {
    return std::exp(static_cast<double>(time - reference_) / tau_);
  }
  /// Adds `amount`, already times factor(s), to output i.
  void add(std::size_t i, double amount) {
    const double total = sum_[i] + amount;
    const double added = total - sum_[i];
    error_[i] += (sum_[i] - (total - added)) + (amount - added);
    sum_[i] = total;
  }

  /// exp(-(t - r) / tau): the factor of all outputs' values at time t.
  double decay(TimeNs time) const {
    return std::exp(-static_cast<double>(time - reference_) / tau_);
  }
  /// y_i(t), where `decay_factor` is decay(t).
  double value(std::size_t i, double decay_factor) const {
    return (sum_[i] + error_[i]) * decay_factor;
  }
  std::size_t outputs() const { return sum_.size(); }

 private:
  double tau_;  // ns
  TimeNs reference_ = 0;
  std::vector<double> sum_;
  std::vector<double> error_;
};

}  // namespace spikeloop
