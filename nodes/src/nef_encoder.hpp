// `nef_encoder`: a population of integrate-and-fire neurons that encodes a vector (Eliasmith &
// Anderson 2003, Neural Engineering, ch. 4).
#pragma once

#include "spikeloop/core/node.hpp"

namespace spikeloop {

/// Neuron n gets the current  bias_n + gain_n (e_n . x)  of the whole input vector x, where e_n is
/// a unit vector, and is a leaky integrate-and-fire neuron:
///     tau_m dV/dt = -V + (tau_m / c_m) I;  V > v_th: a spike, and V = 0 for t_ref.
/// Its spike times are solved for, not stepped to: at a constant input the interval between spikes
/// is  t_ref + tau_m ln(V_inf / (V_inf - v_th))  with V_inf = tau_m I / c_m.
/// The defaults are those of ros_music_adapter.
NodeClass nef_encoder_class();

}  // namespace spikeloop
