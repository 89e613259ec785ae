#!/usr/bin/python3
"""Integrate-and-fire neurons with lateral inhibition, in Brian2."""
import spikeloop.brian
from brian2 import NeuronGroup, Synapses, ms, prefs

prefs.codegen.target = "numpy"  # nothing to compile; leave it out for large networks
with spikeloop.brian.music(spikes_in={"in": None}, spikes_out={"out": None}) as host:
    source = host.input("in")
    neurons = NeuronGroup(len(source), "dv/dt = -v / (20*ms) : 1", threshold="v > 1", reset="v = 0",
                          refractory=2 * ms, method="exact")
    forward = Synapses(source, neurons, on_pre="v_post += 0.5", delay=1 * ms)
    forward.connect(j="i")
    inhibition = Synapses(neurons, neurons, on_pre="v_post -= 0.05", delay=1 * ms)
    inhibition.connect("i != j")
    host.output("out", neurons)
    host.run()
