// `nef_encoder`: a population of integrate-and-fire neurons that encodes a vector (Eliasmith &
// Anderson 2003, Neural Engineering, ch. 4).
#pragma once

#include "spikeloop/core/node.hpp"

namespace spikeloop {

/// Neuron n gets the current  bias_n + gain_n (e_n . x)  of the whole input vector x, where e_n is
/// a unit vector, and is a leaky integrate-and-fire neuron:
///     tau_m dV/dt = -V + R I;  at the threshold: a spike, and V = 0 for t_ref.
/// The time at which V meets the threshold is solved for, not stepped to: at a constant input
/// T = tau_m ln(R I / (R I - v_th)) after V was 0. With `spike_times=interpolated` the interval
/// between spikes is t_ref + T; on a grid of step h, t_ref + ceil(T / h) h. As Nengo's, neurons of
/// `preset=nengo` never have a potential below 0: they answer at once when their input comes back.
NodeClass nef_encoder_class();

}  // namespace spikeloop
