#!/usr/bin/python3
import spikeloop.neuron
from neuron import h

with spikeloop.neuron.music(spikes_in={"in": None}, spikes_out={"out": None}, cvode=False,
                            delay=spikeloop.Parameter(1.5e-3, unit="s")) as host:
    cells = []
    for channel in range(host.widths["in"]):
        cell = h.IntFire1()
        cell.refrac = 0
        host.connect_input("in", channel, cell, weight=2, delay_ms=host.parameters["delay"] * 1e3)
        host.connect_output("out", channel, cell)
        cells.append(cell)
    h.CVode().active(host.parameters["cvode"])
    host.run()
