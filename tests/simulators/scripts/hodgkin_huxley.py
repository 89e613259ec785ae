#!/usr/bin/python3
import spikeloop.neuron
from neuron import h

from ball_and_stick import ball_and_stick

with spikeloop.neuron.music(spikes_in={"in": None}, spikes_out={"out": 1}, cvode=False) as host:
    cell = ball_and_stick(h)
    for channel in range(host.widths["in"]):
        host.connect_input("in", channel, cell.synapse, weight=0.004, delay_ms=0.7)
    host.connect_output("out", 0, cell.soma(0.5)._ref_v, sec=cell.soma, threshold_mV=0)
    if host.parameters["cvode"]:
        h.CVode().active(True)
        h.CVode().atol(1e-9)
        h.CVode().condition_order(2)
    host.run(v_init_mV=-65)
