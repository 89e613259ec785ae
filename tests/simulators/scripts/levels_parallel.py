#!/usr/bin/python3
"""A continuous output of several processes: all say the same."""
import numpy as np
import spikeloop.neuron
from neuron import h

with spikeloop.neuron.music(spikes_in={"in": None}, spikes_out={"out": None},
                            signals_out={"level": 5}) as host:
    pc = h.ParallelContext()
    h.finitialize(-65)
    for tick in host:
        host.advance(tick)
        mean = pc.allreduce(pc.id(), 1) / pc.nhost()  # of 0, 1, 2
        tick.write("level", mean + tick.end_s + np.arange(5) / 10)
