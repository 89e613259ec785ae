// The values that the neurons of a population prefer: what `population_encoder` and
// `population_vector` have in common.
#pragma once

#include <cstdint>
#include <vector>

#include "spikeloop/core/node.hpp"

namespace spikeloop {

/// The values that a population covers. On a circle, `minimum` and `maximum` are one point.
struct ValueRange {
  double minimum = -1.0;
  double maximum = 1.0;
  bool circular = false;

  double length() const { return maximum - minimum; }
};

/// Appends value_min, value_max, circular.
void append_value_range(std::vector<ParameterDescription>& parameters);
/// @throws ConfigurationError unless value_min < value_max.
ValueRange value_range(const Parameters& given);

/// The distance between neighbours of `neurons` preferred values: the range divided by the neurons
/// on a circle, else by the gaps between them; one neuron alone has the whole range.
double spacing(const ValueRange& range, std::uint32_t neurons);
/// Preferred values in ascending order: from minimum to maximum, both included; on a circle from
/// the minimum on, without the maximum. One neuron alone prefers the middle of a range that is
/// none.
std::vector<double> preferred_values(const ValueRange& range, std::uint32_t neurons);

/// How many neurons there are for each value. `neurons` and `values` are indices of ports.
/// @throws ConfigurationError with both widths when the one is not a multiple of the other.
std::uint32_t neurons_a_value(const NodeSetup& setup, std::size_t neurons, std::size_t values);

}  // namespace spikeloop
