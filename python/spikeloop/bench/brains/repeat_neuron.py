#!/usr/bin/python3
"""One artificial cell of NEURON's a channel, which repeats every spike after a millisecond."""
import spikeloop.neuron
from neuron import h

with spikeloop.neuron.music(spikes_in={"in": None}, spikes_out={"out": None},
                            delay=spikeloop.Parameter(1e-3, unit="s")) as host:
    h.dt = 1
    cells = []
    for channel in range(host.widths["in"]):
        cell = h.IntFire1()
        cell.refrac = 0
        host.connect_input("in", channel, cell, weight=2, delay_ms=host.parameters["delay"] * 1e3)
        host.connect_output("out", channel, cell)
        cells.append(cell)
    host.run()
