#!/usr/bin/python3
"""A neuron in NEST that learns which of its inputs come together: spike-timing-dependent plasticity."""
import numpy as np
import spikeloop.nest
import nest

with spikeloop.nest.music(spikes_in={"in": 20}, spikes_out={"out": 1}) as host:
    nest.resolution = 0.1
    neuron = nest.Create("iaf_psc_exp", params={"tau_syn_ex": 3.0, "tau_minus": 20.0})
    # STDP needs a neuron at both ends: parrots repeat what comes in.
    inputs = nest.Create("parrot_neuron", 20)
    nest.Connect(host.input("in"), inputs, "one_to_one", {"delay": 1.0})
    nest.Connect(inputs, neuron, "all_to_all", {
        "synapse_model": "stdp_synapse", "weight": 150.0, "delay": 1.0, "Wmax": 400.0,
        "lambda": 0.01, "alpha": 1.1, "mu_plus": 0.0, "mu_minus": 0.0, "tau_plus": 20.0})
    host.output("out", neuron)
    synapses = nest.GetConnections(inputs, neuron)
    weights = []
    for tick in host:
        host.advance(tick)
        if tick.end_ns % 1_000_000_000 == 0:  # every second
            weights.append(synapses.weight)
np.save("weights.npy", weights)
