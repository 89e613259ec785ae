#!/usr/bin/python3
"""A neuron of Brian2's a channel, which repeats every spike a step later."""
import spikeloop.brian
from brian2 import NeuronGroup, Synapses, defaultclock, ms

defaultclock.dt = 1 * ms
with spikeloop.brian.music(spikes_in={"in": None}, spikes_out={"out": None}) as host:
    source = host.input("in")
    cells = NeuronGroup(len(source), "v : 1", threshold="v > 0.5", reset="v -= 1")
    synapses = Synapses(source, cells, on_pre="v_post += 1")
    synapses.connect(j="i")
    host.output("out", cells)
    host.run()
