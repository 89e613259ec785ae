// Exact integration of the linear membrane equation over one step (Rotter & Diesmann 1999).
#pragma once

#include "spikeloop/config/network_file.hpp"

namespace spikeloop::neurons {

/// exp(-h / tau), h and tau in ms: the decay of a current or of the membrane over a step.
double decay(double h, double tau);

/// What a synaptic current of 1 pA at the beginning of a step, decaying with tau_syn, adds to the
/// membrane potential at its end, in mV: 1/C_m * integral from 0 to h of
/// exp(-(h - s) / tau_m) exp(-s / tau_syn) ds. Also right where tau_m and tau_syn are equal or
/// nearly so. Times in ms, C_m in pF.
double current_to_membrane(double h, double tau_m, double tau_syn, double C_m);

/// What a constant current of 1 pA adds over a step, in mV.
double constant_to_membrane(double h, double tau_m, double C_m);

/// The refractory period in steps, rounded up as in NEST. Times in ns.
long refractory_steps(const NeuronParameters& parameters, TimeNs resolution);

}  // namespace spikeloop::neurons
