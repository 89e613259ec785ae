// `population_vector`: the mean of what the neurons prefer, weighted with their rates
// (Georgopoulos, Schwartz & Kettner 1986).
#pragma once

#include "spikeloop/core/node.hpp"

namespace spikeloop {

/// out[k] = sum_i r_i d_ki / sum_i r_i, where r_i is the rate of neuron i, filtered with an
/// exponential kernel, and d_ki what it prefers. All rates decay alike, so that the value changes
/// at spikes alone and is held between them.
///
/// `directions = even`: output k is decoded from the neurons k*n to k*n + n-1 alone, which prefer
/// evenly spaced values: the code of `population_encoder`. Else a table, a row an output and a
/// column a neuron; then every neuron counts for every output.
/// `circular`: values are angles, value_max is value_min, and out[k] is the angle of the sum of
/// vectors of length r_i and angle d_ki, in [value_min, value_max); where that sum is shorter than
/// 1e-9 of the sum of the lengths, the last value is held.
///
/// An output whose kernels add up to less than 1e-100 at the latest spike holds its last value.
/// `out` is invalid until every output has one.
NodeClass population_vector_class();

}  // namespace spikeloop
