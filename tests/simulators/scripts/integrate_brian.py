#!/usr/bin/python3
import spikeloop.brian
from brian2 import prefs

from brian_network import network_of

prefs.codegen.target = "numpy"
with spikeloop.brian.music(spikes_in={"in": None}, spikes_out={"out": 20}) as host:
    source = host.input("in")
    network, cells = network_of(source)
    host.output("out", cells)
    host.run(network)
