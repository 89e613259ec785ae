// `population_encoder`: each value in the rates of neurons with Gaussian receptive fields (Bohte,
// La Poutre & Kok 2002).
#pragma once

#include "spikeloop/core/node.hpp"

namespace spikeloop {

/// Channel d is encoded by the neurons d*n to d*n + n-1, where n is the width of `out` divided by
/// that of `in`. Their preferred values mu are evenly spaced from value_min to value_max, and
///     rate = rate_min + (rate_max - rate_min) exp(-(x - mu)^2 / (2 sigma^2)).
/// `sigma = auto` is the spacing divided by beta = 1.5: the rule of Bohte et al., whose fields lie
/// (max - min) / (n - 2) apart, the outer two beyond the range; here the outer two lie on its ends.
/// It holds for every n, with the whole range as the spacing of one neuron. On a circle, x - mu is
/// the shorter way round. Values outside the range are not clipped: all fields are far from them.
/// Spikes are regular (of rate_encoder) or Poisson (of poisson_encoder), with their exactness.
NodeClass population_encoder_class();

}  // namespace spikeloop
