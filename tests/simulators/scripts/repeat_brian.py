#!/usr/bin/python3
import sys

# Brian2 works without these; to import them takes half of its start.
sys.modules.update(dict.fromkeys(("Cython", "matplotlib", "pytest")))
import spikeloop.brian
from brian2 import NeuronGroup, Synapses, defaultclock, ms, prefs

prefs.codegen.target = "numpy"
defaultclock.dt = 0.5 * ms
with spikeloop.brian.music(spikes_in={"in": None}, spikes_out={"out": None}) as host:
    source = host.input("in")
    cells = NeuronGroup(len(source), "v : 1", threshold="v > 0.5", reset="v -= 1")
    synapses = Synapses(source, cells, on_pre="v_post += 1")
    synapses.connect(j="i")
    host.output("out", cells)
    host.run()
