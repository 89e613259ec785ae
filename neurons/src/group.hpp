// The neurons of one population, advanced step by step on the grid.
#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <vector>

#include "spikeloop/config/network_file.hpp"

namespace spikeloop::neurons {

/// Step n is the interval ((n - 1) h, n h] of the grid with resolution h.
class Group {
 public:
  Group() = default;
  Group(const Group&) = delete;
  Group& operator=(const Group&) = delete;
  virtual ~Group() = default;

  /// One spike of a source reaches these targets at the end of `step`, at most the longest delay
  /// after the last updated step.
  virtual void receive(std::int64_t step, std::span<const std::uint32_t> targets,
                       std::span<const double> weights) = 0;
  /// Advances to the end of `step`; appends who fired, once a spike.
  virtual void update(std::int64_t step, std::vector<std::uint32_t>& fired) = 0;
  /// What flows into each neuron beside I_e, pA, from the next step on; for models with a membrane.
  virtual std::span<double> current() { return {}; }
  /// Membrane potential at the end of the last step, mV; NaN for models without a membrane.
  virtual double potential(std::uint32_t) const { return std::numeric_limits<double>::quiet_NaN(); }
};

/// Spikes on their way, summed by target: a row of `size` weights for every step up to the longest
/// delay.
class RingBuffer {
 public:
  RingBuffer(std::uint32_t size, std::int64_t longest_delay)
      : size_(size),
        rows_(longest_delay + 1),
        values_(size * static_cast<std::size_t>(longest_delay + 1), 0.0) {}

  std::span<double> row(std::int64_t step) {
    return std::span(values_).subspan(static_cast<std::size_t>(step % rows_) * size_, size_);
  }

 private:
  std::size_t size_;
  std::int64_t rows_;
  std::vector<double> values_;
};

/// `longest_delay` in steps, over all projections into this population.
std::unique_ptr<Group> make_group(const NetworkPopulation& population, TimeNs resolution,
                                  std::int64_t longest_delay);

}  // namespace spikeloop::neurons
