#!/usr/bin/python3
from brian_network import network_of  # before Brian2, which spikeloop.brian imports

import spikeloop.brian
from brian2 import prefs

prefs.codegen.target = "numpy"
with spikeloop.brian.music(spikes_in={"in": None}, spikes_out={"out": 20}) as host:
    source = host.input("in")
    network, cells = network_of(source)
    host.output("out", cells)
    host.run(network)
